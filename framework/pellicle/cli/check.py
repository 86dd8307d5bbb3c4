"""``pellicle check``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from pellicle.errors import ConfigError

from .printing import NOT_CONVERGED, echo, print_json, print_table, print_warning

if TYPE_CHECKING:
    from pellicle.config.run import Run
    from pellicle.runs.advice import Advice

_IN_WAVE = 8
"""Cells in the shortest wave of an indenter below which its areas are warned of: with four, the
published rough punch under 100 mN/m has a corrected area of 9.8 % in place of 8.6 %."""
_ROUND_OFF = 1e-9
"""Relative error below which a quantity counts as prescribed."""


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
    from pellicle.config.doubtful_scales import doubtful_scales
    from pellicle.config.study import Study, from_toml
    from pellicle.runs.advice import advise
    from pellicle.runs.memory_estimate import memory_of
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
            checked.append(_Checked(name, run, advise(run, allowed), memory_of(run)))
        except ConfigError as problem:
            raise ConfigError(f"{problem} (run with {name})") if name else problem from None
    if json:
        data = [
            advice._asdict()
            | {"steps": [step._asdict() for step in advice.steps], "memory": needed}
            for _, _, advice, needed in checked
        ]
        of_runs = [{"run": one.name, **of_run} for one, of_run in zip(checked, data, strict=True)]
        print_json({"runs": of_runs} if isinstance(configuration, Study) else data[0])
        raise typer.Exit(NOT_CONVERGED if any(one.advice.at_edge for one in checked) else 0)
    if isinstance(configuration, Study):
        _print_study(checked, allowed)
    else:
        _print_run(checked[0], allowed)
    cells = min(one.advice.cells_in_wave or math.inf for one in checked)
    if cells < _IN_WAVE * (1 - 1e-9):
        echo(
            f"the shortest wave of the indenter has {cells:.3g} cells: areas are known to a tenth "
            f"or two only; use {_IN_WAVE} or more"
        )
    if reaching := [one for one in checked if one.advice.at_edge]:
        for name, _, advice, _ in reaching:
            steps = f"step{'s' * (len(advice.at_edge) > 1)} {', '.join(map(str, advice.at_edge))}"
            echo(f"{name}{': ' * bool(name)}the contact of {steps} reaches the edge of the domain")
        echo(f"{_domain(reaching)} holds every step; the errors are for such a domain")
        raise typer.Exit(NOT_CONVERGED)
    if isinstance(configuration, Study) and all(one.advice.size for one in checked):
        echo(
            f"every contact fits into a smaller domain: {_domain(checked)}; the points of a run "
            "are for the domain that fits its own"
        )


class _Checked(NamedTuple):
    """A run with its advice."""

    name: str
    """The values that distinguish it in its study; empty for a single run."""
    run: Run
    advice: Advice
    memory: float
    """Memory that it needs [bytes]."""


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


def _print_run(checked: _Checked, error: float) -> None:
    from pellicle.units import readable

    _, run, advice, needed = checked
    quantities = [q for q in ("force", "depth") if _worst(advice, f"{q}_error") > _ROUND_OFF]
    rows = [
        {
            "step": str(step.step),
            "force": readable(step.force, "N", 3),
            "cells across": f"{step.cells:.0f}",
            **{f"error of {name}": _share(getattr(step, f"{name}_error")) for name in quantities},
            "error of area": _share(step.area_error),
        }
        for step in advice.steps
    ]
    print_table(list(rows[0]), rows)
    nx, ny = run.grid.points
    echo(f"{nx} × {ny} cells need {needed / 1e6:.3g} MB; errors are at most about these")
    if advice.size and not advice.at_edge:
        echo(f"the contact fits into a smaller domain: {_domain([checked])}")
    if advice.size or advice.points != run.grid.points:
        nx, ny = advice.points
        of, on = " and ".join(quantities), ", on that domain" if advice.size else ""
        echo(f"for {_share(error)} of {of} in every step{on}: grid.points = [{nx}, {ny}]")


def _print_study(checked: Sequence[_Checked], error: float) -> None:
    """Print the worst of each run, and how many runs exceed the allowed error."""
    rows = []
    for name, _, advice, needed in checked:
        across = [step.cells for step in advice.steps if not math.isnan(step.error)]
        nx, ny = advice.points
        row = {
            "run": name,
            "steps": str(len(advice.steps)),
            "fewest cells across": f"{min(across):.0f}" if across else "0",
            "error": _share(_worst(advice, "error")),
            "error of area": _share(_worst(advice, "area_error")),
            f"points for {_share(error)} of force and depth": f"{nx} × {ny}",
            "memory": f"{needed / 1e6:.3g} MB",
        }
        rows.append(row)
    print_table(list(rows[0]), rows)
    errors = [(w, one.name) for one in checked if (w := _worst(one.advice, "error")) == w]
    areas = [(w, one.name) for one in checked if (w := _worst(one.advice, "area_error")) == w]
    many = sum(w > error for w, _ in errors)
    echo(
        f"{len(checked)} runs; in {many} the error of force or depth may exceed "
        f"{_share(error)} in some step; errors are at most about these"
    )
    if errors:
        (worst, of_force), (area, of_area) = max(errors), max(areas)
        echo(f"the worst: {_share(worst)}, with {of_force}; of area {_share(area)}, with {of_area}")


def _domain(checked: Sequence[_Checked]) -> str:
    """Return the setting of a domain that holds the contacts of several runs."""
    from pellicle.units import readable

    x, y = (max(one.advice.size[n] for one in checked if one.advice.size) for n in (0, 1))
    return f'grid.size = ["{readable(x, "m", 3)}", "{readable(y, "m", 3)}"]'


def _worst(advice: Advice, of: str) -> float:
    """Return the largest of an error over the steps; NaN without contact."""
    errors = [getattr(step, of) for step in advice.steps]
    return max((e for e in errors if not math.isnan(e)), default=math.nan)


def _share(value: float) -> str:
    return "no contact" if value != value else f"{float(f'{100 * value:.2g}'):g} %"
