"""Cells on a skin that bends settle as the least bending energy has them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from pellicle import Grid, Problem
from pellicle.operators import make_operator
from pellicle_plugins.kernels.bending_skin import BendingSkin
from pellicle_plugins.solvers import relaxation
from pellicle_plugins.solvers.extension import biharmonic, stretch_of
from pellicle_plugins.solvers.inner_solve import Inner
from pellicle_plugins.solvers.relaxation import relaxed

Array = NDArray[np.float64]
SHAPE = (16, 12)
MARGIN = 1e-6


def plate(dx: float, dy: float, shape: tuple[int, int] = SHAPE) -> Problem:
    """Return a problem whose gap is its displacement, under a skin that nothing but bends."""
    grid = Grid(points=shape, size=(dx * shape[0], dy * shape[1]), boundary="periodic")
    operator = make_operator(BendingSkin(reduced_modulus=1e-12, bending=1.0), grid)
    return Problem(grid, operator, np.zeros(shape), "depth", 0.0)


def bending_matrix(dx: float, dy: float) -> Array:
    """Return Δ² between the cells [1/m⁴]."""
    stretch = stretch_of(dx, dy)
    units = np.eye(SHAPE[0] * SHAPE[1], dtype=np.float32).reshape(-1, *SHAPE)
    columns = [biharmonic(unit, stretch).ravel() for unit in units]
    return np.array(columns, dtype=np.float64) / (stretch[0] * dx**2) ** 2


def loaded(contact: NDArray[np.bool_], seed: int) -> Inner:
    """Return pressures on a contact, of which one in four pulls, and a gap that is in part < 0."""
    random = np.random.default_rng(seed)
    pressure = np.where(contact, random.uniform(-1, 3, contact.shape), 0.0)
    gap = np.where(contact, 0.0, random.uniform(-0.05, 1, contact.shape))
    return Inner(pressure, gap, 0.0, np.flatnonzero((pressure < 0) | (gap < -MARGIN)))


@pytest.mark.parametrize("spacing", [(1.0, 1.0), (1.0, 1.5), (2.0, 1.0)])
@pytest.mark.parametrize("seed", range(5))
def test_optimality(
    spacing: tuple[float, float], seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After many steps, by K as a matrix: no force off contact, no pull on it, no penetration."""
    monkeypatch.setattr(relaxation, "_STEPS", 4000)
    problem = plate(*spacing)
    before = np.random.default_rng(seed).uniform(size=SHAPE) < 0.6
    found = loaded(before, seed)
    contact, forces = relaxed(problem, before, found, MARGIN)
    on, floor = contact.ravel(), -np.where(before, 0.0, found.displacement + MARGIN).ravel()
    stiffness = bending_matrix(*spacing)
    opened = np.where(on, floor, 0.0)
    load = found.pressure.ravel() + stiffness @ opened
    opened[~on] = np.linalg.solve(stiffness[np.ix_(~on, ~on)], -load[~on])
    force = found.pressure.ravel() + stiffness @ opened
    assert (opened >= floor - 1e-4).all()
    assert force[on].min() >= -1e-3
    np.testing.assert_allclose(forces.ravel(), np.where(on, force, 0), atol=1e-3 * force.max())
    assert forces.sum() == pytest.approx(found.pressure.sum(), rel=1e-4)


def test_what_is_right_stays() -> None:
    """Where nothing pulls and nothing penetrates, nothing moves."""
    before = np.zeros(SHAPE, dtype=bool)
    before[4:9, 3:8] = True
    found = loaded(before, 1)
    found = found._replace(pressure=np.abs(found.pressure), displacement=np.abs(found.displacement))
    contact, forces = relaxed(plate(1.0, 1.0), before, found, MARGIN)
    np.testing.assert_array_equal(contact, before)
    np.testing.assert_allclose(forces, found.pressure, rtol=1e-6)


def test_turned_by_a_right_angle() -> None:
    """Along y as along x, for cells of two to three."""
    before = np.random.default_rng(7).uniform(size=SHAPE) < 0.5
    found = loaded(before, 7)
    contact, forces = relaxed(plate(2.0, 3.0), before, found, MARGIN)
    turned = Inner(found.pressure.T, found.displacement.T, 0.0, found.wrong)
    contact_turned, forces_turned = relaxed(plate(3.0, 2.0, SHAPE[::-1]), before.T, turned, MARGIN)
    np.testing.assert_array_equal(contact_turned, contact.T)
    np.testing.assert_allclose(forces_turned, forces.T, atol=1e-4 * forces.max())


def test_penetration_within_the_margin_is_none() -> None:
    """A cell that penetrates by less than the margin does not join; by more it does."""
    before = np.zeros(SHAPE, dtype=bool)
    before[4:9, 3:8] = True
    found = loaded(before, 1)
    gap = np.where(before, 0.0, 1.0)
    for depth, joins in ((0.5 * MARGIN, False), (100 * MARGIN, True)):
        gap[12, 6] = -depth
        one = found._replace(pressure=np.abs(found.pressure), displacement=gap)
        contact, _ = relaxed(plate(1.0, 1.0), before, one, MARGIN)
        assert contact[12, 6] == joins
