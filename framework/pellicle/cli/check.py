"""``pellicle check``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pellicle.errors import ConfigError

from .exits import NOT_CONVERGED
from .printing import echo, print_json, print_table, print_warning

if TYPE_CHECKING:
    from pellicle.config.run import Run
    from pellicle.config.study import Study
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

    allowed = _allowed(error.strip())
    configuration = from_toml(file, set_ or ())
    for doubt in doubtful_scales(configuration).values():
        print_warning(doubt)
    if isinstance(configuration, Study):
        _check_study(configuration, allowed, json=json)
    else:
        _check_run(configuration, allowed, json=json)


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


def _check_run(run: Run, error: float, *, json: bool) -> None:
    from pellicle.runs.advice import advise
    from pellicle.runs.memory_estimate import memory_of
    from pellicle.units import readable

    advice = advise(run, error)
    needed = memory_of(run)
    if json:
        print_json(_data(advice, needed))
        raise typer.Exit(NOT_CONVERGED if advice.at_edge else 0)
    quantities = [name for name in ("force", "depth") if _is_unknown(advice, name)]
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
        x, y = (readable(edge, "m", 3) for edge in advice.size)
        echo(f'the contact fits into a smaller domain: grid.size = ["{x}", "{y}"]')
    if advice.size or advice.points != run.grid.points:
        nx, ny = advice.points
        of, on = " and ".join(quantities), ", on that domain" if advice.size else ""
        echo(f"for {_share(error)} of {of} in every step{on}: grid.points = [{nx}, {ny}]")
    _warn_of_waves([advice])
    _refuse_edge([(advice, "")])


def _warn_of_waves(checked: Sequence[Advice]) -> None:
    """Print the fewest cells in the shortest wave of an indenter, if they are few."""
    cells = min((advice.cells_in_wave or math.inf for advice in checked), default=math.inf)
    if cells < _IN_WAVE * (1 - 1e-9):
        echo(
            f"the shortest wave of the indenter has {cells:.3g} cells: areas are known to a tenth "
            f"or two only; use {_IN_WAVE} or more"
        )


def _refuse_edge(checked: Sequence[tuple[Advice, str]]) -> None:
    """Print of which domains the contact reaches the edge, and one for all; exit if there are any.

    ``checked`` has the advice of each run with its name, empty for a single run.
    """
    from pellicle.units import readable

    reaching = [(advice, name) for advice, name in checked if advice.at_edge]
    if not reaching:
        return
    for advice, name in reaching:
        steps = f"step{'s' * (len(advice.at_edge) > 1)} {', '.join(map(str, advice.at_edge))}"
        echo(f"{name}{': ' * bool(name)}the contact of {steps} reaches the edge of the domain")
    x, y = (readable(max(a.size[n] for a, _ in reaching if a.size), "m", 3) for n in (0, 1))
    echo(f'grid.size = ["{x}", "{y}"] holds every step; the errors are for such a domain')
    raise typer.Exit(NOT_CONVERGED)


def _row(name: str, advice: Advice, needed: float, error: float) -> dict[str, str]:
    """Return the line of a run in the table of a study; ``needed`` is its memory [bytes]."""
    across = [step.cells for step in advice.steps if not math.isnan(step.error)]
    nx, ny = advice.points
    return {
        "run": name,
        "steps": str(len(advice.steps)),
        "fewest cells across": f"{min(across):.0f}" if across else "0",
        "error": _share(_worst(advice, "error")),
        "error of area": _share(_worst(advice, "area_error")),
        f"points for {_share(error)} of force and depth": f"{nx} × {ny}",
        "memory": f"{needed / 1e6:.3g} MB",
    }


def _check_study(study: Study, error: float, *, json: bool) -> None:
    """Print the worst of each run, and how many runs exceed the allowed error.

    A smaller domain is suggested only where it fits every run.
    """
    from pellicle.runs.advice import advise
    from pellicle.runs.memory_estimate import memory_of
    from pellicle.studies.planned import check_outputs
    from pellicle.studies.summary import run_names
    from pellicle.studies.table import StudyTable
    from pellicle.units import readable

    check_outputs(study)
    names = run_names(StudyTable(study).dataset())
    checked: list[tuple[str, Advice, float]] = []
    for name, point in zip(names, study.points, strict=True):
        try:
            checked.append((name, advise(point.run, error), memory_of(point.run)))
        except ConfigError as problem:
            raise ConfigError(f"{problem} (run with {name})") from None
    if json:
        print_json(
            {"runs": [{"run": name, **_data(advice, needed)} for name, advice, needed in checked]}
        )
        raise typer.Exit(NOT_CONVERGED if any(a.at_edge for _, a, _ in checked) else 0)
    rows = [_row(name, advice, needed, error) for name, advice, needed in checked]
    print_table(list(rows[0]), rows)
    errors = [(w, name) for name, advice, _ in checked if (w := _worst(advice, "error")) == w]
    areas = [(w, name) for name, advice, _ in checked if (w := _worst(advice, "area_error")) == w]
    many = sum(w > error for w, _ in errors)
    echo(
        f"{len(checked)} runs; in {many} the error of force or depth may exceed "
        f"{_share(error)} in some step; errors are at most about these"
    )
    if errors:
        (worst, of_force), (area, of_area) = max(errors), max(areas)
        echo(f"the worst: {_share(worst)}, with {of_force}; of area {_share(area)}, with {of_area}")
    _warn_of_waves([advice for _, advice, _ in checked])
    _refuse_edge([(advice, name) for name, advice, _ in checked])
    if any(advice.size is None for _, advice, _ in checked):
        return
    edges = [max(advice.size[axis] for _, advice, _ in checked if advice.size) for axis in (0, 1)]
    x, y = (readable(edge, "m", 3) for edge in edges)
    echo(
        f'every contact fits into a smaller domain: grid.size = ["{x}", "{y}"]; the points of a '
        "run are for the domain that fits its own"
    )


def _data(advice: Advice, needed: float) -> dict[str, Any]:
    return {
        "steps": [step._asdict() for step in advice.steps],
        "points": advice.points,
        "size": advice.size,
        "at_edge": advice.at_edge,
        "cells_in_wave": advice.cells_in_wave,
        "memory": needed,
    }


def _worst(advice: Advice, of: str) -> float:
    """Return the largest of an error over the steps; NaN without contact."""
    errors = [getattr(step, of) for step in advice.steps]
    return max((e for e in errors if not math.isnan(e)), default=math.nan)


def _is_unknown(advice: Advice, name: str) -> bool:
    """Return whether a quantity has errors beyond round-off in a step: it is not prescribed."""
    return _worst(advice, f"{name}_error") > _ROUND_OFF


def _share(value: float) -> str:
    return "no contact" if value != value else f"{float(f'{100 * value:.2g}'):g} %"
