"""The solution on a coarser grid, as a start on a finer one."""

from __future__ import annotations

from typing import Final

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConfigError
from pellicle.numerics.grid_transfer import prolong
from pellicle.numerics.problem import Problem
from pellicle.numerics.solution import Solution

from .scaling import ScaledSolver

# Relative tolerance on coarse grids: under tension even an error below that of the discretisation
# moves the contact edge by several cells.
_COARSE_TOLERANCE: Final = 1e-5
# Grids of up to this many cells along the longer edge are not coarsened.
_COARSEST: Final = 48


def coarser(problem: Problem) -> Problem | None:
    """Return the problem on a coarser grid; None if the grid is coarse or its kernel needs it."""
    if max(problem.grid.shape) <= _COARSEST:
        return None
    try:
        return problem.coarsened()
    except ConfigError:
        # A thin incompressible layer is rigid under cells much wider than its thickness.
        return None


def coarse_solution(solver: ScaledSolver, coarse: Problem) -> Solution:
    """Return the solution of a coarse problem from scratch, by ``solver`` at a loose tolerance."""
    tolerance = max(solver.tolerance, _COARSE_TOLERANCE)
    loose = solver.model_copy(update={"tolerance": tolerance})
    return loose.solve(coarse, None, lambda iteration, residual_ratio: None)


def prolonged(pressure: Array, problem: Problem) -> Array | None:
    """Return a pressure of the coarser grid on the grid of ``problem`` [Pa]; None if it is 0."""
    finer = prolong(pressure, problem.grid.shape)
    # A coarse cell may extend beyond the rim of the indenter.
    finer *= np.isfinite(problem.profile)
    return finer if finer.any() else None
