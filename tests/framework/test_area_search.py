"""The search for a contact area, on staircases that are known."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle.components import Solver
from pellicle.operators import make_operator
from pellicle.problem import Problem
from pellicle.runs.target_search import reach_area

GRID = pl.Grid(points=11, size=11.0, boundary="periodic")


class Staircase(Solver):
    """Puts as many cells in contact as a function of the force says."""

    cells: Any

    def solve(self, problem: Problem, start: Any, monitor: Any) -> pl.Solution:
        """Return a pressure on the first cells."""
        pressure = np.zeros(problem.grid.points)
        pressure.ravel()[: self.cells(problem.value)] = 1.0
        return pl.Solution(pressure, 2)


def search(cells: Callable[[float], int], area: float, start: float | None = None) -> Any:
    """Return what is reached on a staircase."""
    x, y = GRID.coordinates()
    kernel = pl.kernel("winkler", foundation=1.0)
    profile = np.asarray(-(x**2 + y**2))
    problem = Problem(GRID, make_operator(kernel, GRID), profile, "force", 0.0)
    before = None
    if start is not None:
        pressure = np.zeros(GRID.shape)
        pressure.ravel()[:4] = start / 4
        before = pl.State(pressure, pressure, 0.0)
    return reach_area(problem, area, Staircase(cells=cells), before, lambda *_: None)


@pytest.mark.parametrize("start", [None, 1e-6, 1.0, 1e6])
@pytest.mark.parametrize("power", [0.4, 1.0])
def test_whole_cells_are_met(power: float, start: float | None) -> None:
    """Where each number of cells can be had, the number is met from wherever it starts."""

    def cells(force: float) -> int:
        return min(max(round(40 * float(force**power)), 1), 100)

    for area in (0.5, 3.0, 40.4, 99.6):
        found = search(cells, area, start)
        assert found.how == "met"
        count = cells(found.problem.value)
        assert abs(count - area) <= 0.5
        assert found.missed == pytest.approx(abs(count - area) / area)
        assert found.solution.iterations % 2 == 0


@pytest.mark.parametrize(("area", "side"), [(32.0, 30), (37.0, 40)])
def test_jump_is_found(area: float, side: int) -> None:
    """Where the area jumps across what is wanted, the force is the jump's, on the nearer side."""
    jump = 7.3
    found = search(lambda force: 30 if force < jump else 40, area)
    assert found.how == "nearest"
    assert found.problem.value == pytest.approx(jump, rel=2e-4)
    assert np.count_nonzero(found.solution.pressure) == side
    assert found.missed == pytest.approx(abs(side - area) / area)


@pytest.mark.parametrize("area", [20.0, 60.0])
def test_area_that_no_force_brings(area: float) -> None:
    """The search ends, and says that it found nothing."""
    found = search(lambda force: 30, area)
    assert found.how == "not found"
    assert found.missed == pytest.approx(abs(30 - area) / area)
