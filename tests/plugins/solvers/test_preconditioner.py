"""Forces off the contact are moved onto it so that they do there what they did."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from pellicle import Grid, Problem
from pellicle_plugins.kernels.skins import BendingSkin
from pellicle_plugins.solvers.contact_cg import _Directions
from pellicle_plugins.solvers.preconditioner import (
    OnContact,
    Preconditioner,
    _free_shape,
    _halvings,
    _round_up,
)
from tests.plugins.solvers.problems import BOUNDARIES, Boundary, make, skin

Array = NDArray[np.float64]
SHAPE = (20, 24)
KERNELS = {
    "half-space": skin(0.0),
    "tension": skin(20.0),
    "bending": BendingSkin(reduced_modulus=1.0, bending=1e3),
}


def problem(kernel: str, boundary: Boundary) -> Problem:
    """Return a flat punch on 20 × 24 square cells under a force."""
    return make(SHAPE, boundary, KERNELS[kernel], 0.0, "force", 1.0, (1.0, 1.2))


def island() -> NDArray[np.bool_]:
    """Return a contact with a ragged edge, away from the domain's."""
    contact = np.zeros(SHAPE, dtype=bool)
    contact[5:15, 6:17] = True
    return contact & (np.random.default_rng(3).uniform(size=SHAPE) < 0.9)


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("kernel", KERNELS)
def test_forces_on_the_contact_stay(kernel: str, boundary: Boundary) -> None:
    """To the last digit, and nothing is left off the contact."""
    contact = island()
    forces = np.where(contact, np.random.default_rng(1).standard_normal(SHAPE), 0.0)
    on_contact = Preconditioner(problem(kernel, boundary).operator).on(contact)
    np.testing.assert_array_equal(on_contact.transferred(forces), forces)
    forces[0, 0] = 1.0
    assert not on_contact.transferred(forces)[~contact].any()


def test_a_skin_that_bends_keeps_the_force() -> None:
    """What E keeps, a constant, is what its transpose keeps of forces, up to single precision."""
    random = np.random.default_rng(2)
    contact = random.uniform(size=SHAPE) < 0.3
    forces = random.uniform(-1e5, 2e5, size=SHAPE)
    operator = problem("bending", "periodic").operator
    moved = Preconditioner(operator).on(contact).transferred(forces)
    assert moved.sum() == pytest.approx(forces.sum(), rel=1e-5)


@pytest.mark.parametrize(
    ("kernel", "share"), [("half-space", 0.7), ("tension", 0.45), ("bending", 0.06)]
)
def test_pressure_of_cells_that_leave(kernel: str, share: float) -> None:
    """Moved to those that stay it nearly keeps them where they were, against dense algebra.

    ``share`` bounds the energy norm of the error over that of dropping what the cells bore.
    """
    operator = problem(kernel, "periodic").operator
    units = np.eye(SHAPE[0] * SHAPE[1]).reshape(-1, *SHAPE)
    compliance = np.array([operator(unit).ravel() for unit in units])
    x, y = operator.grid.coordinates()
    profile = -(x**2) - y**2

    def exact(contact: NDArray[np.bool_]) -> Array:
        on = contact.ravel()
        pressure = np.zeros(on.size)
        pressure[on] = np.linalg.solve(compliance[np.ix_(on, on)], 1 + profile[contact])
        return pressure.reshape(SHAPE)

    def error(pressure: Array) -> float:
        wrong = pressure - exact(stay)
        return float(np.sqrt(np.vdot(wrong, operator(wrong))))

    before = island()
    stay = before & (np.random.default_rng(5).uniform(size=SHAPE) < 0.7)
    pressure = exact(before)
    moved = Preconditioner(operator).on(stay).transferred(pressure)
    assert error(moved) < share * error(np.where(stay, pressure, 0.0))


def test_a_lift_serves_on_a_contact_that_has_changed_little(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of sum 1 on either, it is computed anew for a contact that has lost its cells."""
    applications = 0
    original = OnContact.__call__

    def counted(self: OnContact, residual: Array, mean: float = 0.0) -> NDArray[np.float32]:
        nonlocal applications
        applications += 1
        return original(self, residual, mean)

    monkeypatch.setattr(OnContact, "__call__", counted)
    preconditioner = Preconditioner(problem("tension", "free").operator)
    contact = island()
    changed, other = contact.copy(), ~contact
    changed[9, 8:12] ^= True
    lifts = []
    for cells, expected in ((contact, 1), (changed, 1), (other, 2)):
        lifts.append(preconditioner.lift(preconditioner.on(cells)))
        assert lifts[-1].shape == (np.count_nonzero(cells),)
        assert lifts[-1].sum() == pytest.approx(1.0, rel=1e-12)
        assert applications == expected
    assert 0.9 < lifts[1][(contact & changed)[changed]].sum() / lifts[1].sum() <= 1 + 1e-12


@pytest.mark.parametrize("boundary", BOUNDARIES)
def test_directions_under_a_force_are_symmetric(boundary: Boundary) -> None:
    """With the lift of another contact too: P M Pᵀ is symmetric, of no net force, and positive."""
    punch = problem("tension", boundary)
    preconditioner = Preconditioner(punch.operator)
    contact = island()
    preconditioner.lift(preconditioner.on(contact))
    contact[9, 8:12] ^= True
    directions = _Directions(punch, preconditioner.on(contact), None)
    residuals = np.random.default_rng(4).standard_normal((12, np.count_nonzero(contact)))
    outcomes = np.array([directions(residual) for residual in residuals])
    products = residuals @ outcomes.T
    scale = np.abs(products).max()
    np.testing.assert_allclose(products, products.T, atol=1e-5 * scale)
    assert np.linalg.eigvalsh(products + products.T).min() > 0
    assert np.abs(outcomes.sum(axis=1)).max() < 1e-6 * np.abs(outcomes).sum(axis=1).max()


def test_large_grids_are_halved_to_as_many_cells() -> None:
    """From 4096 cells on the coarsest plane has 32 or more each way."""
    for points, halvings in ((64, 6), (2048, 6), (4095, 6), (4096, 7), (8192, 8), (10000, 8)):
        assert _halvings((points, points)) == halvings
        plane = _round_up((points, points))
        assert plane[0] == plane[1] >= points
        assert plane[0] % 2 ** min(halvings, points.bit_length() - 2) == 0
        assert plane[0] < points + 2**halvings
    assert _halvings((4096, 8)) == 6
    assert _free_shape(Grid(points=4096, size=1.0, boundary="free")) == (5120, 5120)
