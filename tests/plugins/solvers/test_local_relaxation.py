"""Cells on a skin that bends settle as the least energy has them; few are solved exactly."""

import numpy as np
import pytest

from pellicle import Problem, Stop
from pellicle.arrays import Array, Mask
from pellicle.contact import measure
from pellicle_plugins.kernels.skins import BendingSkin
from pellicle_plugins.solvers import active_set, window
from pellicle_plugins.solvers.active_set import ActiveSet
from pellicle_plugins.solvers.bending import relaxation
from pellicle_plugins.solvers.bending.few_cells import solved_on_few_cells
from pellicle_plugins.solvers.bending.relaxation import relax_locally
from pellicle_plugins.solvers.contact_cg import InnerSolution
from pellicle_plugins.solvers.preconditioner import CirculantStiffness, Preconditioner
from tests.plugins.solvers.problems import BOUNDARIES, Boundary, Prescribed, make, solve

SHAPE = (16, 12)
MARGIN = 1e-6


def plate(dx: float, dy: float, shape: tuple[int, int] = SHAPE) -> Problem:
    """Return a problem whose gap is its displacement, under a skin that nothing but bends."""
    kernel, size = BendingSkin(reduced_modulus=1e-12, bending=1.0), (dx * shape[0], dy * shape[1])
    return make(shape, "periodic", kernel, 0.0, "depth", 0.0, size)


def settle(
    problem: Problem, contact: Mask, inner: InnerSolution, margin: float = MARGIN
) -> tuple[Mask, Array]:
    """Return what `relax_locally` makes of what an inner solve found on a contact."""
    on_contact = Preconditioner(problem.operator).on(contact)
    return relax_locally(problem, on_contact, inner, margin)


def stiffness_matrix(problem: Problem) -> Array:
    """Return K between the cells [Pa/m]."""
    stiffness = CirculantStiffness(problem.operator, problem.grid.shape)
    units = np.eye(stiffness.shape[0] * stiffness.shape[1], dtype=np.float32)
    columns = [stiffness(unit).ravel() for unit in units.reshape(-1, *stiffness.shape)]
    return np.array(columns, dtype=np.float64) * stiffness.greatest


def loaded(contact: Mask, seed: int, left: float = 0.0) -> InnerSolution:
    """Return pressures on a contact, of which one in four pulls, and a gap that is in part < 0.

    On the contact the gap is up to ``left``, of either sign.
    """
    random = np.random.default_rng(seed)
    pressure = np.where(contact, random.uniform(-1, 3, contact.shape), 0.0)
    gap = np.where(contact, 0.0, random.uniform(-0.05, 1, contact.shape))
    gap += np.where(contact, random.uniform(-left, left, contact.shape), 0.0)
    return InnerSolution(pressure, gap, left, np.flatnonzero((pressure < 0) | (gap < -MARGIN)))


def test_stiffness_undoes_the_operator() -> None:
    """K u is the pressure that displaces a periodic surface by u, but for its mean."""
    random = np.random.default_rng(4)
    for spacing in ((1.0, 1.0), (2.0, 3.0)):
        problem = plate(*spacing)
        pressure = random.standard_normal(SHAPE)
        pressure -= pressure.mean()
        stiffness = CirculantStiffness(problem.operator, SHAPE)
        again = stiffness(problem.operator(pressure).astype(np.float32)) * stiffness.greatest
        np.testing.assert_allclose(again, pressure, atol=2e-4)


@pytest.mark.parametrize("spacing", [(1.0, 1.5), (2.0, 1.0)])
@pytest.mark.parametrize("left", [0.0, 0.02])
@pytest.mark.parametrize("seed", range(2))
def test_optimality(
    spacing: tuple[float, float], left: float, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After many steps, by K as a matrix: no force off contact, no pull on it, no penetration.

    What gap was left on the contact is closed.
    """
    monkeypatch.setattr(relaxation, "_STEPS", 6000)
    problem = plate(*spacing)
    before = np.random.default_rng(seed).uniform(size=SHAPE) < 0.6
    inner = loaded(before, seed, left)
    contact, forces = settle(problem, before, inner)
    floor = -(inner.displacement + np.where(before, 0.0, MARGIN)).ravel()
    on, stiffness = contact.ravel(), stiffness_matrix(problem)
    opened = np.where(on, floor, 0.0)
    load = inner.pressure.ravel() + stiffness @ opened
    opened[~on] = np.linalg.solve(stiffness[np.ix_(~on, ~on)], -load[~on])
    force = inner.pressure.ravel() + stiffness @ opened
    assert (opened >= floor - 1e-4).all()
    assert force[on].min() >= -1e-3
    np.testing.assert_allclose(forces.ravel(), np.where(on, force, 0), atol=1e-3 * force.max())


def test_a_gap_that_is_left_everywhere_is_closed_by_its_force() -> None:
    """In full contact nothing can settle: the forces are those that close the gap, p − K g."""
    everywhere = np.ones(SHAPE, dtype=bool)
    inner = loaded(everywhere, 2, 1e-3)
    inner = inner._replace(pressure=np.full(SHAPE, 1.0))
    problem = plate(1.0, 1.0)
    contact, forces = settle(problem, everywhere, inner)
    closed = 1.0 - stiffness_matrix(problem) @ inner.displacement.ravel()
    assert closed.min() > 0
    assert contact.all()
    np.testing.assert_allclose(forces.ravel(), closed, rtol=1e-4)


def test_what_is_right_stays() -> None:
    """Where nothing pulls and nothing penetrates, nothing moves."""
    before = np.zeros(SHAPE, dtype=bool)
    before[4:9, 3:8] = True
    inner = loaded(before, 1)
    inner = inner._replace(pressure=np.abs(inner.pressure), displacement=np.abs(inner.displacement))
    contact, forces = settle(plate(1.0, 1.0), before, inner)
    np.testing.assert_array_equal(contact, before)
    np.testing.assert_allclose(forces, inner.pressure, rtol=1e-6)


def test_turned_by_a_right_angle() -> None:
    """Along y as along x, for cells of two to three."""
    before = np.random.default_rng(7).uniform(size=SHAPE) < 0.5
    inner = loaded(before, 7, 0.01)
    contact, forces = settle(plate(2.0, 3.0), before, inner)
    turned = InnerSolution(inner.pressure.T, inner.displacement.T, 0.0, inner.misclassified)
    contact_turned, forces_turned = settle(plate(3.0, 2.0, SHAPE[::-1]), before.T, turned)
    np.testing.assert_array_equal(contact_turned, contact.T)
    np.testing.assert_allclose(forces_turned, forces.T, atol=1e-4 * forces.max())


def test_penetration_within_the_margin_is_none() -> None:
    """A cell that penetrates by less than the margin does not join; by more it does."""
    before = np.zeros(SHAPE, dtype=bool)
    before[4:9, 3:8] = True
    inner = loaded(before, 1)
    gap = np.where(before, 0.0, 1.0)
    for depth, joins in ((0.5 * MARGIN, False), (100 * MARGIN, True)):
        gap[12, 6] = -depth
        one = inner._replace(pressure=np.abs(inner.pressure), displacement=gap)
        contact, _ = settle(plate(1.0, 1.0), before, one)
        assert contact[12, 6] == joins


def a_contact_at(place: tuple[int, int], shape: tuple[int, int]) -> InnerSolution:
    """Return an inner solution on a disc, with misclassified cells along its edge, moved."""
    x, y = (np.arange(n) - n // 2 for n in shape)
    distance = np.hypot(x[:, None], y)
    random = np.random.default_rng(6)
    pressure = np.where(distance < 9, random.uniform(-0.2, 1, shape), 0.0)
    gap = np.where(distance < 9, 0.0, 1e-3 * (distance - 9.5))
    fields = [np.roll(field, place, (0, 1)) for field in (pressure, gap)]
    wrong = (fields[0] < 0) | (fields[1] < -MARGIN)
    return InnerSolution(fields[0], fields[1], 0.0, np.flatnonzero(wrong))


def test_a_window_gives_the_contact_of_the_whole_grid(monkeypatch: pytest.MonkeyPatch) -> None:
    """Around a small contact on a large grid; forces differ by what acts far off the contact."""
    shape = (256, 240)
    problem, inner = plate(1.0, 1.0, shape), a_contact_at((0, 0), shape)
    contact = inner.pressure != 0
    windowed, forces = settle(problem, contact, inner)
    monkeypatch.setattr(window, "_WHOLE", 0.0)
    whole, expected = settle(problem, contact, inner)
    assert (contact ^ whole).sum() > 30
    np.testing.assert_array_equal(windowed, whole)
    np.testing.assert_allclose(forces[whole], expected[whole], atol=0.02 * expected.max())


@pytest.mark.parametrize("place", [(128, 0), (0, 120), (125, 118)])
def test_a_window_reaches_across_the_edges_of_the_grid(place: tuple[int, int]) -> None:
    """A contact that straddles the edges of the periodic plane settles as it does amid it."""
    shape = (256, 240)
    problem = plate(1.0, 1.0, shape)
    (amid, forces), (across, moved) = (
        settle(problem, inner.pressure != 0, inner)
        for inner in (a_contact_at((0, 0), shape), a_contact_at(place, shape))
    )
    np.testing.assert_array_equal(across, np.roll(amid, place, (0, 1)))
    np.testing.assert_allclose(moved, np.roll(forces, place, (0, 1)), atol=2e-3 * forces.max())


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
