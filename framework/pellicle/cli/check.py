"""``pellicle check``."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Annotated

import typer

from pellicle.errors import ConfigError

from .printing import NOT_CONVERGED, echo, print_json, print_table, print_warning


def check(
    file: Annotated[Path, typer.Argument(help="TOML file of a run or a study.")],
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Replace a value of the file."),
    ] = None,
    error: Annotated[
        str,
        typer.Option(help="Allowed relative error of force and depth: 1% or 0.01."),
    ] = "1%",
    json: Annotated[bool, typer.Option("--json", help="Print JSON, in SI.")] = False,
) -> None:
    """Check a run or a study, and estimate its errors and memory from coarser grids."""
    from pellicle.config.study import Study, from_toml
    from pellicle.runs.advice import advise
    from pellicle.runs.memory_estimate import memory_of
    from pellicle.show import advice
    from pellicle.show.doubtful_scales import doubtful_scales
    from pellicle.studies.runner import tasks

    allowed = _allowed(error.strip())
    configuration = from_toml(file, set_ or ())
    for doubt in doubtful_scales(configuration).values():
        print_warning(doubt)
    if isinstance(configuration, Study):
        runs = [(task.name, task.run) for task in tasks(configuration, Path())]
    else:
        runs = [("", configuration)]
    checked = []
    for name, run in runs:
        try:
            checked.append(advice.Advised(name, run, advise(run, allowed), memory_of(run)))
        except ConfigError as problem:
            raise ConfigError(f"{problem} (run with {name})") if name else problem from None
    is_study = isinstance(configuration, Study)
    if json:
        data = [
            of_run._asdict()
            | {"steps": [step._asdict() for step in of_run.steps], "memory": needed}
            for _, _, of_run, needed in checked
        ]
        of_runs = [{"run": one.name, **row} for one, row in zip(checked, data, strict=True)]
        print_json({"runs": of_runs} if is_study else data[0])
    else:
        table, sentences = (
            (advice.errors_of_runs(checked, allowed), advice.advice_on_runs(checked, allowed))
            if is_study
            else (advice.errors_of_run(checked[0]), advice.advice_on_run(checked[0], allowed))
        )
        print_table(table)
        for sentence in (*sentences, *advice.contacts_at_edge(checked)):
            echo(sentence)
    raise typer.Exit(NOT_CONVERGED if any(one.advice.at_edge for one in checked) else 0)


def _allowed(text: str) -> float:
    """Return the relative error that a share or a percentage states."""
    with suppress(ValueError):
        share = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
        if 1e-6 <= share <= 0.5:
            return share
    raise ConfigError(
        f"{text!r} is not allowed; give a percentage from 0.0001% to 50%, or a share such as 0.01",
        "--error",
    )
