"""Forces off the contact are moved onto it so that they do there what they did."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from pellicle import Problem
from pellicle.arrays import Array
from pellicle_plugins.kernels.skins import BendingSkin
from pellicle_plugins.solvers.contact_cg import _Directions
from pellicle_plugins.solvers.preconditioner import Preconditioner
from tests.plugins.solvers.problems import BOUNDARIES, Boundary, make, skin

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
