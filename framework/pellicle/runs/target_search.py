"""The load step of a prescribed contact area: the force under which as many cells touch.

The area of the cells in contact is a staircase of the force. Searched for is the stair whose area
is nearest to the prescribed one: any force on it where it is within half a cell, or else the force
at which the area passes the prescribed one, to `_WIDTH`, on its nearer side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Final, Literal, NamedTuple

import numpy as np
from scipy.optimize import brentq

from pellicle.components import Monitor, Solver
from pellicle.components.calls import solution_of
from pellicle.numerics.initial_guess import overlap_pressure
from pellicle.numerics.problem import Force, Problem
from pellicle.numerics.solution import Solution, State

# Of the logarithm of the force where the area jumps across the prescribed one.
_WIDTH: Final = 1e-4
# Forces tried before it is taken that none brings such an area.
_MOST_TRIES: Final = 40


class Reached(NamedTuple):
    """The load step whose area is the nearest."""

    problem: Problem
    """With the force that was found."""
    solution: Solution
    """Its iterations are those of the whole search."""
    missed: float
    """|A − prescribed| / prescribed."""
    how: Literal["met", "nearest", "not found"]
    """Whether the area is within half a cell; or else whether no force brings a nearer one."""


def reach_area(
    problem: Problem, area: float, solver: Solver, start: State | None, monitor: Monitor
) -> Reached:
    """Return the load step with a contact area [m²] > 0; the value of ``problem`` is not used.

    The root of log A over log F is bracketed and found (Brent 1973). Each try starts from the
    pressure of the one before, the first from ``start`` if that is not None.
    """
    search = _Search(replace(problem, control=Force(0.0)), area, solver, monitor, start)
    low = high = math.log(_first_force(problem, area, start))
    below = above = search(low)
    while below > 0 and len(search.tried) < _MOST_TRIES:
        high, above = low, below
        low -= _stride(below, len(search.tried))
        below = search(low)
    while above < 0 and len(search.tried) < _MOST_TRIES:
        low, below = high, above
        high += _stride(above, len(search.tried))
        above = search(high)
    if below < 0 < above:
        brentq(search, low, high, xtol=_WIDTH, rtol=1e-15)
    how: Literal["met", "nearest", "not found"] = "nearest" if below < 0 < above else "not found"
    return Reached(
        replace(search.problem, control=Force(search.force)),
        replace(search.solution, iterations=search.iterations),
        search.missed,
        "met" if 0.0 in search.tried.values() else how,
    )


def _stride(excess: float, tries: int) -> float:
    """Return how far to go in log F for log A to pass its goal; further each time it does not.

    A ~ F^(2/3) at most, under a smooth indenter; A ~ F under tension or where it is rough.
    """
    return min(1.5 * abs(excess) + 0.02 * 2.0**tries, math.log(30.0))


def _first_force(problem: Problem, area: float, start: State | None) -> float:
    """Return the force of the step before, scaled as its area is, or that of an overlap."""
    cell = problem.grid.cell_area
    if start is not None and start.contact.any():
        before = float(np.count_nonzero(start.contact)) * cell
        return float(start.pressure.sum()) * cell * math.pow(area / before, 1.5)
    heights = np.sort(problem.profile[np.isfinite(problem.profile)])[::-1]
    lowest = heights[min(math.ceil(area / cell + 0.5), heights.size - 1)]
    # Deeper than that by a little: at a cell's very height it is round-off whether it touches.
    overlap = np.maximum(problem.profile - 1.01 * lowest, 0.0)
    return cell * float(overlap_pressure(problem.operator, overlap).sum())


@dataclass
class _Search:
    """Solves for one force after the other, and keeps the nearest area."""

    problem: Problem
    area: float
    solver: Solver
    monitor: Monitor
    start: State | None
    """The state of the last try, from which the next one starts."""
    tried: dict[float, float] = field(default_factory=dict)
    """log F → log A/A*, 0 where A is within half a cell of A*."""
    iterations: int = 0
    missed: float = math.inf
    force: float = field(init=False)
    solution: Solution = field(init=False)

    def __call__(self, log_force: float) -> float:
        """Return log A/A*."""
        if log_force not in self.tried:
            self.tried[log_force] = self._try(math.exp(log_force))
        return self.tried[log_force]

    def _try(self, force: float) -> float:
        problem = replace(self.problem, control=Force(force))
        found = solution_of(self.solver, problem, self.start, self.monitor)
        self.start = State(found.pressure, found.pressure, math.nan)
        self.iterations += found.iterations
        cell = self.problem.grid.cell_area
        area = float(np.count_nonzero(found.pressure > 0)) * cell
        missed = abs(area - self.area) / self.area
        # Of equals the later is nearer to the jump.
        if missed <= self.missed:
            self.missed, self.force, self.solution = missed, force, found
        return 0.0 if abs(area - self.area) <= cell / 2 else math.log(area / self.area)
