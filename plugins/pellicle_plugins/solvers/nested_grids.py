"""The solution on a coarser grid, as a start on a finer one."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from pellicle.contact import Adhesive, Problem, State
from pellicle.errors import ConfigError
from pellicle.surface import highest, prolong

from .scaling import ScaledSolver

# Relative tolerance on coarse grids: under tension even an error below that of the discretisation
# moves the contact edge by several cells.
_COARSE_TOLERANCE: Final = 1e-5
# Grids of up to this many cells along the longer edge are not coarsened.
_COARSEST: Final = 48


def coarse_start(solver: ScaledSolver, problem: Problem) -> State | None:
    """Return the state of a coarser grid, by ``solver``, on the grid of ``problem``.

    None if the grid is coarse, its kernel needs it, or nothing is in contact on the coarser one.
    """
    if max(problem.grid.shape) <= _COARSEST:
        return None
    try:
        coarse = problem.coarsened()
    except ConfigError:
        # A thin incompressible layer is rigid under cells much wider than its thickness.
        return None
    if not coarse.needs_solving:
        if isinstance(problem, Adhesive):
            return None
        # The indenter touches less than half of every coarse cell.
        coarse = replace(coarse, profile=highest(problem.profile, coarse.grid.shape))
    loose = solver.model_copy(update={"tolerance": max(solver.tolerance, _COARSE_TOLERANCE)})
    state = loose.solve(coarse, None, lambda iteration, residual_ratio: None).state
    # A coarse cell may extend beyond the rim of the indenter.
    below = np.isfinite(problem.profile)
    wall = prolong(state.wall, problem.grid.shape)
    wall *= below
    pressure = wall
    if state.pressure is not state.wall:
        pressure = prolong(state.pressure, problem.grid.shape)
        pressure *= below
    return State(pressure, wall, state.depth) if wall.any() else None
