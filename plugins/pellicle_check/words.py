"""Words on the grid of a run: tables of expected errors, and advice."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from pellicle import Run
from pellicle.components import Table
from pellicle.units import readable

from .advice import Advice

_IN_WAVE = 8
"""Cells in the shortest wave of an indenter below which its areas are warned of: with four, the
published rough punch under 100 mN/m has a corrected area of 9.8 % in place of 8.6 %."""
_ROUND_OFF = 1e-9
"""Relative error below which a quantity counts as prescribed."""


class RunAdvice(NamedTuple):
    """A run with its advice."""

    name: str
    """The values that distinguish it in its study; empty for a single run."""
    run: Run
    advice: Advice
    memory: float
    """Memory that it needs [bytes]."""


def errors_of_run(advised: RunAdvice) -> Table:
    """Return the expected errors of each step."""
    quantities = _erring(advised.advice)
    rows = [
        (
            str(step.step),
            readable(step.force, "N", 3),
            f"{step.cells:.0f}",
            *(_share(getattr(step, f"{name}_error")) for name in quantities),
            _share(step.area_error),
        )
        for step in advised.advice.steps
    ]
    errors = [f"error of {name}" for name in (*quantities, "area")]
    return Table.of_rows(("step", "force", "cells across", *errors), rows)


def advice_on_run(advised: RunAdvice, allowed: float) -> Iterator[str]:
    """Yield what a run needs, and a grid that keeps its errors below what is ``allowed``."""
    _, run, advice, needed = advised
    nx, ny = run.grid.points
    of_path = ", those of force over the largest on the path" * bool(run.interaction)
    yield f"{nx} × {ny} cells need {needed / 1e6:.3g} MB; errors are at most about these{of_path}"
    if advice.size and not advice.at_edge:
        yield f"the contact fits into a smaller domain: {_domain([advised])}"
    if advice.size or advice.points != run.grid.points:
        nx, ny = advice.points
        of, on = " and ".join(_erring(advice)), ", on that domain" if advice.size else ""
        yield f"for {_share(allowed)} of {of} in every step{on}: grid.points = [{nx}, {ny}]"
    yield from _of_waves([advised])


def errors_of_runs(advised: Sequence[RunAdvice], allowed: float) -> Table:
    """Return the worst of each run of a study."""
    rows = []
    for name, _, advice, needed in advised:
        across = [step.cells for step in advice.steps if not math.isnan(step.error)]
        nx, ny = advice.points
        cells = f"{min(across):.0f}" if across else "0"
        errors = _share(_worst(advice, "error")), _share(_worst(advice, "area_error"))
        steps, memory = str(len(advice.steps)), f"{needed / 1e6:.3g} MB"
        rows.append((name, steps, cells, *errors, f"{nx} × {ny}", memory))
    points = f"points for {_share(allowed)} of force and depth"
    heads = "run", "steps", "fewest cells across", "error", "error of area", points, "memory"
    return Table.of_rows(heads, rows)


def advice_on_runs(advised: Sequence[RunAdvice], allowed: float) -> Iterator[str]:
    """Yield how many runs exceed the allowed error, and which are the worst."""
    errors = [(w, run.name) for run in advised if (w := _worst(run.advice, "error")) == w]
    areas = [(w, run.name) for run in advised if (w := _worst(run.advice, "area_error")) == w]
    many = sum(w > allowed for w, _ in errors)
    yield (
        f"{len(advised)} runs; in {many} the error of force or depth may exceed "
        f"{_share(allowed)} in some step; errors are at most about these"
    )
    if errors:
        (worst, of_force), (area, of_area) = max(errors), max(areas)
        yield f"the worst: {_share(worst)}, with {of_force}; of area {_share(area)}, with {of_area}"
    yield from _of_waves(advised)
    if all(run.advice.size and not run.advice.at_edge for run in advised):
        yield (
            f"every contact fits into a smaller domain: {_domain(advised)}; the points of a run "
            "are for the domain that fits its own"
        )


def contacts_at_edge(advised: Sequence[RunAdvice]) -> Iterator[str]:
    """Yield which steps reach the edge of the domain, and a domain that holds all; or nothing."""
    reaching = [entry for entry in advised if entry.advice.at_edge]
    for name, run, advice, _ in reaching:
        steps = f"step{'s' * (len(advice.at_edge) > 1)} {', '.join(map(str, advice.at_edge))}"
        what = f"the contact{', or the zone around it,' * bool(run.interaction)} of {steps}"
        yield f"{name}{': ' * bool(name)}{what} reaches the edge of the domain"
    if reaching:
        yield f"{_domain(reaching)} holds every step; the errors are for such a domain"


def _of_waves(advised: Sequence[RunAdvice]) -> Iterator[str]:
    cells = min(entry.advice.cells_in_wave or math.inf for entry in advised)
    if cells < _IN_WAVE * (1 - 1e-9):
        yield (
            f"the shortest wave of the indenter has {cells:.3g} cells: areas are known to a tenth "
            f"or two only; use {_IN_WAVE} or more"
        )


def _erring(advice: Advice) -> list[str]:
    """Return the quantities that are not prescribed in all steps."""
    return [name for name in ("force", "depth") if _worst(advice, f"{name}_error") > _ROUND_OFF]


def _domain(advised: Sequence[RunAdvice]) -> str:
    """Return the setting of a domain that holds the contacts of several runs."""
    x, y = (max(entry.advice.size[n] for entry in advised if entry.advice.size) for n in (0, 1))
    return f'grid.size = ["{readable(x, "m", 3)}", "{readable(y, "m", 3)}"]'


def _worst(advice: Advice, of: str) -> float:
    """Return the largest of an error over the steps; NaN without contact."""
    errors = [getattr(step, of) for step in advice.steps]
    return max((e for e in errors if not math.isnan(e)), default=math.nan)


def _share(value: float) -> str:
    return "no contact" if value != value else f"{float(f'{100 * value:.2g}'):g} %"
