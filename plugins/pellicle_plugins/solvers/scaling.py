"""Scale heights and pressures of a problem to near 1 for the solvers."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from pellicle.components import IterativeSolver, Monitor
from pellicle.contact import Adhesive, Problem, Solution, State

# Units are 2^±900 at most, so that 2^100 times a unit is still a number.
_MAX_EXPONENT = 900
# 2^±100 is a number in single precision, and so is its square in double precision.
_SINGLE_EXPONENT = 100


class ScaledSolver(IterativeSolver):
    """Iterative solver whose heights and pressures are near 1.

    Numbers below 1e-38 underflow in single precision, squares below 1e-308 in double precision;
    displacements on a domain of 1e-12 m would. The units are powers of two, so no digit changes.
    """

    def solve(self, problem: Problem, start: State | None, monitor: Monitor) -> Solution:
        """Iterate in scaled units; see `IterativeSolver.solve`."""
        height = height_unit(problem)
        pressure = height / problem.operator.unit
        # Squares of a pressure far above those of this step would overflow.
        if start is not None and float(start.pressure.max()) / pressure < 2.0**_SINGLE_EXPONENT:
            start = _scaled(start, 1 / height, 1 / pressure)
        else:
            start = None
        solution = super().solve(problem.scaled(height, pressure), start, monitor)
        return replace(solution, state=_scaled(solution.state, height, pressure))


def _scaled(state: State, length: float, pressure: float) -> State:
    """Return a state in other units, its arrays in C order."""
    scaled = np.multiply(state.pressure, pressure, order="C")
    wall = scaled
    if state.wall is not state.pressure:
        wall = np.multiply(state.wall, pressure, order="C")
    return State(scaled, wall, state.depth * length)


def height_unit(problem: Problem) -> float:
    """Return a power of two near the heights [m] that determine the contact.

    Under depth control this is the extent of the indenter below the undeformed surface. Under force
    control it is the geometric mean of the indenter's height range and of the displacement of the
    most compliant wave under the mean pressure; either may be much smaller than the other.
    """
    if isinstance(problem, Adhesive):
        # Depth and force may be 0 or negative; what the law does at its cutoff is not.
        heights = max(
            float(problem.law.cutoff()),
            abs(problem.value) if problem.prescribed == "depth" else 0.0,
        )
        return 2.0 ** _exponent(heights)
    if problem.prescribed == "depth":
        return 2.0 ** _exponent(problem.value + float(problem.profile.max()))
    finite = problem.profile[np.isfinite(problem.profile)]
    wave = _exponent(problem.value) + _exponent(problem.operator.unit)
    wave -= _exponent(problem.grid.cell_area) + _exponent(float(problem.profile.size))
    height_range = float(np.ptp(finite)) if finite.size else 0.0
    if not height_range:
        return 2.0 ** _clipped(wave)
    heights = _exponent(height_range)
    lowest = max(heights, wave) - _SINGLE_EXPONENT
    return 2.0 ** _clipped(max((heights + wave) // 2, lowest))


def _exponent(value: float) -> int:
    return _clipped(math.frexp(value)[1])


def _clipped(exponent: int) -> int:
    return max(-_MAX_EXPONENT, min(_MAX_EXPONENT, exponent))
