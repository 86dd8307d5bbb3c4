"""Contract rules of loads: a traction on every cell, the same each time, that deforms a solid."""

from __future__ import annotations

import numpy as np

from pellicle.components import Load
from pellicle.components.calls import traction_of
from pellicle.errors import ConfigError
from pellicle.grid import Grid

from .component import check, require, require_close, rules_of
from .small_runs import HALF_SPACE, solve_small_run


def check_load(load: Load, grid: Grid | None = None) -> None:
    """Check that a load keeps its contract: the rules below, and those of all components.

    The load is asked on the cells of ``grid``; they are 26 × 22, periodic, on 1.3 mm × 1.1 mm if
    None.
    """
    usual = Grid(points=[26, 22], size=["1.3 mm", "1.1 mm"], boundary="periodic")
    check(load, Load, rules_of(__name__), grid or usual)


def traction_is_accepted(load: Load, grid: Grid) -> None:
    """A run accepts traction(x, y), finite float64, the same in a second call, not 0 everywhere."""
    first, second = (traction_of(load.at(0), grid) for _ in range(2))
    require(bool(first.any()), "the traction is 0 on every cell")
    require(np.array_equal(first, second), "the second traction differs")


def force_does_not_depend_on_the_cells(load: Load, grid: Grid) -> None:
    """On cells half as wide the sum of tractions times areas is the same, to 1 % of their sizes."""
    nx, ny = grid.points
    finer = grid.model_copy(update={"points": (2 * nx, 2 * ny)})
    try:
        forces = [traction_of(load.at(0), g) * g.cell_area for g in (grid, finer)]
    except ConfigError:
        # A map has the cells of one grid.
        return
    size = 0.01 * float(np.abs(forces[1]).sum())
    require_close(forces[0].sum(), forces[1].sum(), "the force [N]", absolute=size)


def run_converges(load: Load, grid: Grid) -> None:
    """A half-space under the load is deformed, and the run converges."""
    data = solve_small_run(grid=grid, kernel=HALF_SPACE, indenter=None, load=load)
    require(bool(data["displacement"].values.any()), "no displacement")
