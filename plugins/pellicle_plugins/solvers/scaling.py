"""Solving in numbers near 1, whatever the units and sizes of a problem."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from pellicle.components import IterativeSolver, Monitor
from pellicle.numerics.problem import Problem
from pellicle.numerics.solution import Solution, State

# Greatest exponent of a unit: what is greater than that by 2^100 is still a number.
_LARGEST = 900
# Exponent of what is still a number in single precision, and its square in double.
_FAR = 100


class ScaledSolver(IterativeSolver):
    """Iterative solver whose heights and pressures are near 1.

    In single precision, and where squares are summed, numbers below 1e-38 and 1e-308 are lost; a
    displacement on a domain of 1e-12 m is one. The units are powers of two, which change no digit.
    """

    def solve(self, problem: Problem, start: State | None, monitor: Monitor) -> Solution:
        """Iterate until the tolerance is met, or it is plain that it will not be."""
        height = height_unit(problem)
        pressure = height / problem.operator.unit
        scaled = problem.scaled(height, pressure)
        # Of a pressure beyond all that this step can have, squares are no numbers any more.
        if start is not None and float(start.pressure.max()) / pressure < 2.0**_FAR:
            before = start.pressure / pressure
            start = State(before, before, start.depth / height)
        else:
            start = None
        solution = super().solve(scaled, start, monitor)
        return replace(solution, state=solution.pressure * pressure)


def height_unit(problem: Problem) -> float:
    """Return a power of two near the heights [m] that decide the contact.

    At a depth that is how far the indenter reaches below the undeformed surface. Under a force it
    is the geometric mean of its height range and of the displacement that the force would have as
    the most compliant wave, so that either may be much smaller than the other.
    """
    if problem.prescribed == "depth":
        return 2.0 ** _exponent(problem.value + float(problem.profile.max()))
    finite = problem.profile[np.isfinite(problem.profile)]
    moved = _exponent(problem.value) + _exponent(problem.operator.unit)
    moved -= _exponent(problem.grid.cell_area) + _exponent(float(problem.profile.size))
    reach = float(np.ptp(finite)) if finite.size else 0.0
    if not reach:
        return 2.0 ** _within(moved)
    heights = _exponent(reach)
    # Single precision goes to 2^127.
    return 2.0 ** _within(max((heights + moved) // 2, heights - _FAR, moved - _FAR))


def _exponent(value: float) -> int:
    return _within(math.frexp(value)[1])


def _within(exponent: int) -> int:
    return max(-_LARGEST, min(_LARGEST, exponent))
