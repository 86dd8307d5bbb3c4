"""Extension and preconditioner: transposes, known values, decay, positivity, forces moved."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from pellicle import Kernel, Problem
from pellicle.arrays import Array
from pellicle_plugins.kernels.skins import BendingSkin
from pellicle_plugins.solvers.contact_cg import _Directions
from pellicle_plugins.solvers.multilevel_extension import Extension
from pellicle_plugins.solvers.preconditioner import OnContact, Preconditioner
from tests.plugins.solvers.problems import BOUNDARIES, Boundary, make, skin

SINGLE = float(np.finfo(np.float32).eps)
ORDERS = [0.0, 0.5, 1.0, 1.7, 2.0, 4.0]


def product(one: NDArray[Any], other: NDArray[Any]) -> float:
    """Return Σ one · other in double precision."""
    return float((one.astype(np.float64) * other.astype(np.float64)).sum())


def lone_cell(number: int, orders: list[float]) -> NDArray[np.float32]:
    """Return E of 1 in one cell of a square of ``number``² cells; that cell is in the middle."""
    known = np.zeros((number, number), dtype=bool)
    known[number // 2, number // 2] = True
    return Extension(known, orders).apply(known.astype(np.float32))


@pytest.mark.parametrize("shape", [(8, 8), (32, 64), (96, 16), (160, 112), (64, 1), (1, 40)])
@pytest.mark.parametrize("share", [0.01, 0.3, 0.9, 1.0])
def test_apply_transpose_is_the_transpose_of_apply(shape: tuple[int, int], share: float) -> None:
    """⟨E x, y⟩ = ⟨x, Eᵀ y⟩ to single precision, for any set, shape and order, level by level."""
    random = np.random.default_rng(7)
    for levels in range(4):
        known = random.uniform(size=shape) < share
        known[0, 0] = True
        extension = Extension(known, list(random.choice(ORDERS, levels)))
        x = np.where(known, random.normal(size=shape), 0).astype(np.float32)
        y = random.normal(size=shape).astype(np.float32)
        spread, gathered = extension.apply(x.copy()), extension.apply_transpose(y.copy())
        size = product(np.abs(spread), np.abs(y))
        assert product(spread, y) == pytest.approx(product(x, gathered), abs=10 * SINGLE * size)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("shape", [(48, 32), (48, 1), (1, 96)])
def test_known_values_are_kept(shape: tuple[int, int], order: float) -> None:
    """E changes nothing where the values are given, and E of nothing is nothing."""
    random = np.random.default_rng(3)
    known = random.uniform(size=shape) < 0.2
    extension = Extension(known, [order] * 4)
    values = np.where(known, random.normal(size=known.shape), 0).astype(np.float32)
    spread = extension.apply(values.copy())
    np.testing.assert_array_equal(spread[known], values[known])
    assert (spread[~known] != 0).any()
    assert not extension.apply(np.zeros_like(values)).any()


@pytest.mark.parametrize(("order", "least"), [(1.0, 0.85), (1.5, 0.9), (2.0, 1.0)])
def test_constant_on_a_large_contact_goes_on_as_it_is(order: float, least: float) -> None:
    """Next to a contact much wider than the cells E of 1 is nearly 1, and falls off outwards."""
    known = np.zeros((128, 128), dtype=bool)
    known[32:96, 32:96] = True
    spread = Extension(known, [order] * 6).apply(known.astype(np.float32))
    outwards = spread[31:16:-1, 64]
    assert outwards[0] >= least  # 0.88, 0.93, 1
    assert (np.diff(outwards) <= 0).all()
    assert outwards[-1] > 0.5
    assert spread.max() <= 1 + 4 * SINGLE


def test_lone_cell_of_order_one_decays_as_the_distance() -> None:
    """Of order 1, as for a half-space, E of one cell halves where the distance doubles."""
    spread = lone_cell(256, [1.0] * 8)
    across = np.arange(256) - 128
    distance = np.hypot(across[:, None], across[None, :])
    rings = [spread[(distance >= r / 1.2) & (distance < r * 1.2)].mean() for r in (4, 8, 16, 32)]
    ratios = np.array(rings[1:]) / rings[:-1]
    np.testing.assert_allclose(ratios, 0.5, atol=0.1)


def test_lone_cell_loses_by_its_order() -> None:
    """The one cell of the coarsest level has 2^(α − 2) for each level: 1 at order 2 and above."""
    number = 32
    for order in (o for o in ORDERS if o <= 2):
        spread = lone_cell(number, [order] * 5)
        assert spread.min() == pytest.approx(2.0 ** (5 * (order - 2)), rel=0.5)
    np.testing.assert_array_equal(lone_cell(number, [2.0] * 5), 1.0)
    np.testing.assert_allclose(lone_cell(number, [4.0] * 5), 1.0, rtol=4 * SINGLE)


def preconditioned(boundary: Boundary, contact: NDArray[np.bool_], tension: float) -> OnContact:
    """Return the preconditioner of a tensed half-space on a contact."""
    nx, ny = contact.shape
    size = (1.0, 0.8 * ny / nx)
    problem = make((nx, ny), boundary, skin(2 * tension), 0.0, "depth", 1.0, size)
    return Preconditioner(problem.operator).on(contact)


def matrix(on_contact: OnContact) -> NDArray[np.float64]:
    """Return Eᵀ K E by its columns."""
    return np.array([on_contact(unit) for unit in np.eye(on_contact.cells.size)]).T


# Odd sizes of which one or both are rounded up to what the pyramid needs; thin; a single row.
SHAPES = [(8, 8), (16, 12), (7, 9), (13, 6), (15, 31), (33, 17), (40, 2), (31, 1), (1, 5)]


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("points", SHAPES)
def test_preconditioner_is_symmetric_and_positive(
    points: tuple[int, int], boundary: Boundary
) -> None:
    """On random contacts, full ones too, Eᵀ K E is symmetric to round-off and positive."""
    random = np.random.default_rng(11)
    for share, tension in [(0.15, 0.0), (0.5, 0.02), (1.0, 1.0)]:
        contact = random.uniform(size=points) < share
        contact[-1, -1] = True
        dense = matrix(preconditioned(boundary, contact, tension))
        largest = np.abs(dense).max()
        np.testing.assert_allclose(dense, dense.T, atol=30 * SINGLE * largest)
        assert np.linalg.eigvalsh(dense + dense.T).min() > 0


def test_planes_go_on_where_bending_decides() -> None:
    """Between scattered cells E of a plane is the plane, to a part of its slope over a cell."""
    i, j = np.indices((128, 128)) - 64.0
    plane = (i + 2 * j).astype(np.float32)
    within = np.maximum(np.abs(i), np.abs(j)) < 48
    known = within & (np.random.default_rng(0).uniform(size=plane.shape) < 0.3)
    spread = Extension(known, [4.0] * 4).apply(np.where(known, plane, 0).astype(np.float32))
    inner = np.maximum(np.abs(i), np.abs(j)) < 40
    assert np.abs(spread - plane)[inner].max() < 0.2  # 0.08; with means left where they are 1.4


@pytest.mark.parametrize("order", ORDERS)
def test_a_line_is_a_line_wherever_it_lies(order: float) -> None:
    """Along y as along x; 1 goes on as 1 from order 1 on, a plane where bending decides."""
    random = np.random.default_rng(8)
    known = random.uniform(size=(128, 1)) < 0.3
    values = np.where(known, random.normal(size=known.shape), 0).astype(np.float32)
    along = Extension(known, [order] * 4)
    across = Extension(known.T, [order] * 4)
    for method in ("apply", "apply_transpose"):
        one, other = (getattr(extension, method) for extension in (across, along))
        np.testing.assert_array_equal(one(values.T.copy()), other(values.copy()).T)
    ones = along.apply(known.astype(np.float32))
    if order >= 1:
        np.testing.assert_allclose(ones, 1.0, rtol=8 * SINGLE)
    else:
        assert ones.min() < 0.95
    if order == 4:
        plane = (np.arange(128, dtype=np.float32) - 64)[:, None]
        spread = along.apply(np.where(known, plane, np.float32(0)))
        assert np.abs(spread - plane)[16:-16].max() < 0.3


def condition(kernel: Kernel, points: int | tuple[int, int]) -> float:
    """Return the ratio of the largest eigenvalue of M A to the least, on a disc, free boundary."""
    problem = make(points, "free", kernel, 0.0, "depth", 1.0)
    grid, operator = problem.grid, problem.operator
    on_contact = Preconditioner(operator).on(np.hypot(*grid.coordinates()) < 0.35)
    columns = []
    for cell in on_contact.cells:
        unit = np.zeros(grid.shape)
        unit.flat[cell] = 1.0
        columns.append(operator(unit).flat[on_contact.cells])
    values = np.linalg.eigvals(matrix(on_contact) @ np.array(columns)).real
    assert values.min() > 0
    return float(values.max() / values.min())


@pytest.mark.parametrize("tension", [0.0, 0.05, 5.0])
def test_preconditioner_is_nearly_the_inverse(tension: float) -> None:
    """The eigenvalues of M A on a disc spread over less than a factor of 30, ever fewer cells."""
    assert condition(skin(2 * tension), 24) < 30


@pytest.mark.slow
@pytest.mark.parametrize(
    ("points", "length", "most"),
    [
        (32, 0.1, 4),  # 2.0; with a kink at the edge of the contact 20
        (32, 1.0, 60),  # 48; 200
        ((56, 18), 0.1, 4),  # 2.4; if the cells were taken for squares 6.7
        ((18, 56), 0.1, 4),
        ((56, 18), 1.0, 25),  # 13; 33
        ((18, 56), 1.0, 25),
    ],
)
def test_preconditioner_of_a_skin_that_bends_is_nearly_the_inverse(
    points: int | tuple[int, int], length: float, most: float
) -> None:
    """The extension bends smoothly at the edge, as the cells are long."""
    kernel = BendingSkin(reduced_modulus=1.0, bending=length**3 / 2)
    assert condition(kernel, points) < most


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
    np.testing.assert_array_equal(on_contact.transfer(forces), forces)
    forces[0, 0] = 1.0
    assert not on_contact.transfer(forces)[~contact].any()


def test_a_skin_that_bends_keeps_the_force() -> None:
    """What E keeps, a constant, is what its transpose keeps of forces, up to single precision."""
    random = np.random.default_rng(2)
    contact = random.uniform(size=SHAPE) < 0.3
    forces = random.uniform(-1e5, 2e5, size=SHAPE)
    operator = problem("bending", "periodic").operator
    moved = Preconditioner(operator).on(contact).transfer(forces)
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
    moved = Preconditioner(operator).on(stay).transfer(pressure)
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
