"""Contacts of few cells under a stiff plate are solved exactly, cell by cell."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray

from pellicle import Depth, Force, Grid, Problem, Stop
from pellicle.operators import make_operator
from pellicle.problem import measure
from pellicle_plugins.kernels.bending_skin import BendingSkin
from pellicle_plugins.solvers import active_set, few_cells
from pellicle_plugins.solvers.active_set import ActiveSet
from pellicle_plugins.solvers.few_cells import solved_on_few_cells

Array = NDArray[np.float64]


def rough_plate(
    boundary: Literal["free", "periodic"],
    control: Depth | Force,
    points: tuple[int, int] = (24, 20),
) -> Problem:
    """Return a plate on random waves, cells longer along x, which it touches with few cells."""
    grid = Grid(points=points, size=(1.5, 1.0), boundary=boundary)
    random = np.random.default_rng(2)
    x, y = grid.coordinates()
    profile = np.zeros(points)
    for _ in range(12):
        i, j = random.integers(-3, 4, size=2)
        profile += random.normal() * np.cos(
            2 * np.pi * (i * x / 1.5 + j * y) + random.uniform(0, 7)
        )
    kernel = BendingSkin(reduced_modulus=1.0, bending=0.005)
    return Problem(grid, make_operator(kernel, grid), profile - profile.max(), control)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
@pytest.mark.parametrize("control", [Depth(1.0), Depth(3.0), Force(2.0)])
def test_solution_is_exact(boundary: Literal["free", "periodic"], control: Depth | Force) -> None:
    """From any start on all cells: no pull, no gap under pressure, no penetration, the force."""
    problem = rough_plate(boundary, control)
    unit = np.zeros(problem.grid.shape)
    unit[0, 0] = 1
    column = problem.operator(unit)
    random = np.random.default_rng(6)
    results = []
    for share in (0.02, 0.2):
        trial = np.where(
            random.uniform(size=unit.shape) < share, random.uniform(size=unit.shape), 0
        )
        gap = np.full(unit.shape, -1.0)
        pressure = solved_on_few_cells(problem, column, trial > 0, trial, gap, 1e-12)
        assert pressure is not None
        state = measure(problem, pressure)
        assert pressure.min() == 0
        assert 2 < np.count_nonzero(pressure) < 60
        assert max(state.residual_contact, state.residual_penetration) < 1e-9
        if isinstance(control, Force):
            assert pressure.sum() * problem.grid.cell_area == pytest.approx(
                control.value, rel=1e-12
            )
        results.append(pressure)
    np.testing.assert_allclose(results[0], results[1], atol=1e-6 * results[0].max())


def test_too_many_cells_are_left_to_others() -> None:
    """A contact above the limit, one of no pressure and one of most of the plane are not solved."""
    problem = rough_plate("periodic", Force(2.0))
    shape = problem.grid.shape
    column, gap = np.ones(shape), np.zeros(shape)
    few = np.zeros(shape, dtype=bool)
    many = np.ones(shape, dtype=bool)
    assert many.sum() > few_cells.MOST_CELLS
    for contact in (few, many):
        trial = contact.astype(np.float64)
        assert solved_on_few_cells(problem, column, contact, trial, gap, 0.0) is None
    few[3, 4] = True
    assert solved_on_few_cells(problem, column, few, -few.astype(np.float64), gap, 0.0) is None


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_it_takes_fewer_applications_and_gives_the_same(
    boundary: Literal["free", "periodic"], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A plate on few cells takes a handful of applications, to the same tractions."""
    results, applications = [], []
    for most in (few_cells.MOST_CELLS, 0):
        monkeypatch.setattr(active_set, "MOST_CELLS", most)
        problem = rough_plate(boundary, Force(8.0), (96, 80))
        solution = ActiveSet(tolerance=1e-9).solve(problem, None, lambda *_: None)
        assert solution.stop is Stop.DONE
        results.append(solution.pressure)
        applications.append(problem.operator.applications)
    assert applications[0] <= 8 < applications[1]
    np.testing.assert_allclose(results[0], results[1], atol=1e-4 * results[1].max())
