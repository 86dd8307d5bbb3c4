"""Contacts of few cells under a stiff plate are solved exactly, cell by cell."""

from __future__ import annotations

import numpy as np
import pytest

from pellicle import Problem, Stop
from pellicle.arrays import Array
from pellicle.contact import measure
from pellicle_plugins.kernels.skins import BendingSkin
from pellicle_plugins.solvers import active_set
from pellicle_plugins.solvers.active_set import ActiveSet
from pellicle_plugins.solvers.bending.few_cells import solved_on_few_cells
from tests.plugins.solvers.problems import BOUNDARIES, Boundary, Prescribed, make, solve

KERNEL = BendingSkin(reduced_modulus=1.0, bending=0.005)


def waves(x: Array, y: Array) -> Array:
    """Return random waves on a domain of 1.5 × 1."""
    random = np.random.default_rng(2)
    heights = np.zeros((x.size, y.size))
    for _ in range(12):
        i, j = random.integers(-3, 4, size=2)
        phase = 2 * np.pi * (i * x / 1.5 + j * y)
        heights += random.normal() * np.cos(phase + random.uniform(0, 7))
    return np.asarray(heights - heights.max())


def rough_plate(
    boundary: Boundary, prescribed: Prescribed, value: float, points: tuple[int, int] = (20, 18)
) -> Problem:
    """Return a plate, cells longer along x, that touches random waves with few cells."""
    return make(points, boundary, KERNEL, waves, prescribed, value, (1.5, 1.0))


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize(("prescribed", "value"), [("depth", 1.0), ("depth", 3.0), ("force", 2.0)])
def test_solution_is_exact(boundary: Boundary, prescribed: Prescribed, value: float) -> None:
    """From any start on all cells: no pull, no gap under pressure, no penetration, the force."""
    problem = rough_plate(boundary, prescribed, value)
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
        if prescribed == "force":
            assert state.force == pytest.approx(value, rel=1e-12)
        results.append(pressure)
    np.testing.assert_allclose(results[0], results[1], atol=1e-6 * results[0].max())


@pytest.mark.parametrize("boundary", ["periodic", pytest.param("free", marks=pytest.mark.slow)])
def test_it_takes_fewer_applications_and_gives_the_same(
    boundary: Boundary, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A plate on few cells takes a handful of applications, to the same tractions."""
    solver, problem = ActiveSet(tolerance=1e-9), rough_plate(boundary, "force", 8.0, (96, 80))
    exact = solve(problem, solver)
    monkeypatch.setattr(active_set, "MOST_CELLS", 0)
    usual = solve(problem, solver)
    assert exact.stop is usual.stop is Stop.DONE
    assert exact.applications <= 8 < usual.applications
    np.testing.assert_allclose(exact.pressure, usual.pressure, atol=1e-4 * usual.pressure.max())
