"""``pellicle check``."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Annotated

import typer

from pellicle.cli import NOT_CONVERGED, echo, print_json, print_table
from pellicle.errors import ConfigError


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
    from pellicle import Study
    from pellicle.studies import from_toml, plan_runs, warn_of_scale
    from pellicle_check import words
    from pellicle_check.advice import advise

    allowed = _allowed(error.strip())
    configuration = from_toml(file, set_ or ())
    is_study = isinstance(configuration, Study)
    warn_of_scale(configuration)
    checked = []
    for task in plan_runs(configuration, Path(file.stem)):
        name = task.name if is_study else ""
        try:
            advice = advise(task.run, allowed)
        except ConfigError as problem:
            raise ConfigError(f"{problem} (run with {name})") if name else problem from None
        checked.append(words.RunAdvice(name, task.run, advice, task.memory))
    if json:
        runs = [
            ({"run": name} if is_study else {})
            | advice._asdict()
            | {"steps": [step._asdict() for step in advice.steps], "memory": needed}
            for name, _, advice, needed in checked
        ]
        print_json({"runs": runs} if is_study else runs[0])
    else:
        table, sentences = (
            (words.errors_of_runs(checked, allowed), words.advice_on_runs(checked, allowed))
            if is_study
            else (words.errors_of_run(checked[0]), words.advice_on_run(checked[0], allowed))
        )
        print_table(table)
        for sentence in (*sentences, *words.contacts_at_edge(checked)):
            echo(sentence)
    raise typer.Exit(NOT_CONVERGED if any(entry.advice.at_edge for entry in checked) else 0)


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
