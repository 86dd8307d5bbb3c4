"""Solving in numbers near 1, whatever the units and sizes of a problem."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from pellicle.components import IterativeSolver, Monitor
from pellicle.operators import Array
from pellicle.problem import Problem
from pellicle.result import Solution

# Exponents of the units: their squares and ratios are numbers that a computer has.
_LARGEST = 500


class ScaledSolver(IterativeSolver):
    """Iterative solver whose heights and pressures are near 1.

    In single precision, and where squares are summed, numbers below 1e-38 and 1e-308 are lost; a
    displacement on a domain of 1e-12 m is one. The units are powers of two, which change no digit.
    """

    def solve(self, problem: Problem, start: Array | None, monitor: Monitor) -> Solution:
        """Iterate until the tolerance is met, or it is plain that it will not be."""
        height = height_unit(problem)
        pressure = height / problem.operator.unit
        scaled = problem.scaled(height, pressure)
        before = None if start is None else start / pressure
        solution = super().solve(scaled, before, monitor)
        return replace(solution, pressure=solution.pressure * pressure)


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
    return 2.0 ** _within((_exponent(reach) + moved) // 2 if reach else moved)


def _exponent(value: float) -> int:
    return _within(math.frexp(value)[1])


def _within(exponent: int) -> int:
    return max(-_LARGEST, min(_LARGEST, exponent))
