"""Load steps that start from the last two: same answers, fewer applications, moved fronts."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle.arrays import Mask
from pellicle.components.interaction import law_of
from pellicle.contact.load_step import FinishedStep, start_of
from pellicle.contact.moved_front import moved_on
from pellicle.contact.problem import Depth, Force
from pellicle.contact.solution import State
from pellicle.grid import Boundary
from pellicle_plugins.solvers.active_set import ActiveSet
from tests.plugins.solvers.problems import Shape, make, rough, skin, solve

SOLVER = ActiveSet(tolerance=1e-9)
SHAPES: dict[str, Shape] = {
    "smooth": pl.indenter("paraboloid", radius=2.236).profile,
    "rough": rough(0.125),
}
CASES = [("smooth", "free", Depth), ("rough", "periodic", Force), ("rough", "free", Depth)]


@cache
def problem(shape: str, boundary: Any, tension: float = 0.01, shift: int = 0) -> pl.Problem:
    """Return a problem of 64 x 64 cells at a depth of 0.1, its profile rolled."""
    here = make(64, boundary, skin(2 * tension), SHAPES[shape], "depth", 0.1)
    return replace(here, profile=np.roll(here.profile, shift, (0, 1)))


def steps(here: pl.Problem, values: list[float]) -> list[FinishedStep]:
    """Return the steps of a path, each solved on its own."""
    kind = type(here.control)
    found = (solve(replace(here, control=kind(v)), SOLVER).equilibrium for v in values)
    return [
        FinishedStep(
            e.state, e.gap, e.displacement, 0.0, e.elastic_energy, converged=True, jumped=False
        )
        for e in found
    ]


def sticking(here: pl.Problem, interaction: Any, kernel: Any) -> pl.Adhesive:
    """Return the problem with a law."""
    law = law_of(interaction, kernel, here.grid)
    return pl.Adhesive(here.grid, here.operator, here.profile, here.control, law=law)


def ahead(here: pl.Problem, path: list[FinishedStep]) -> pl.State:
    """Return the state that is extrapolated from a path."""
    start = start_of(here, path[-1].state, path)
    assert start is not None
    assert start is not path[-1].state
    return start


@pytest.mark.parametrize(("shape", "boundary", "control"), CASES)
@pytest.mark.parametrize("direction", [0.05, -0.05])
def test_answer_does_not_depend_on_the_start(
    shape: str, boundary: str, control: type[Depth] | type[Force], direction: float
) -> None:
    """A step from two states ends where it does from none, with fewer applications than from one.

    Measured, from one and from two states: 14 to 22 and 9 to 18.
    """
    value = 0.1 if control is Depth else 0.01
    here = replace(problem(shape, boundary), control=control(value))
    path = steps(here, [value * (1 - 2 * direction), value * (1 - direction)])
    state = path[-1].state
    cold, one = solve(here, SOLVER), solve(here, SOLVER, state)
    two = solve(here, SOLVER, start_of(here, state, path))
    assert two.applications < one.applications
    for warm in (one, two):
        assert warm.residual <= SOLVER.tolerance
        np.testing.assert_array_equal(warm.equilibrium.contact, cold.equilibrium.contact)
        np.testing.assert_allclose(warm.pressure, cold.pressure, atol=1e-5 * cold.pressure.max())


@pytest.mark.parametrize("value", [0.099, 0.1, 0.1021])
def test_nothing_is_extrapolated_backwards_or_far(value: float) -> None:
    """After a reversal, without a step, or beyond twice the last step, the last state is it."""
    here = problem("smooth", "free")
    path = steps(here, [0.099, 0.1])
    assert start_of(replace(here, control=Depth(value)), path[-1].state, path) is path[-1].state
    assert ahead(replace(here, control=Depth(0.101)), path).depth == pytest.approx(0.101)


def test_nothing_is_extrapolated_from_one_state_in_a_solid_that_relaxes_or_where_it_sticks() -> (
    None
):
    """What earlier steps leave behind changes the surface too; with a law a descent is followed."""
    here = problem("smooth", "free")
    path = steps(here, [0.08, 0.09])
    state = path[-1].state
    assert start_of(here, None, ()) is None
    assert start_of(here, state, path[-1:]) is state
    assert start_of(replace(here, left=np.zeros(here.grid.shape)), state, path) is state
    linear = pl.interaction("linear", work_of_adhesion=1.0, range=0.1)
    assert start_of(sticking(here, linear, skin(0.02)), state, path) is state


def test_a_front_moves_on_but_not_on_springs() -> None:
    """With a law without a range a contact that grew grows on, where cells do not yield alone."""
    here, law = problem("smooth", "free"), pl.interaction("jkr", work_of_adhesion=1e-6)
    path = steps(here, [0.08, 0.09])
    state = path[-1].state
    here = replace(here, control=Depth(0.1))
    ahead = start_of(sticking(here, law, skin(0.02)), state, path)
    assert ahead is not None
    assert ahead.contact.sum() > 1.02 * state.contact.sum()
    springs = pl.kernel("winkler", foundation=1.0)
    bed = make(64, "free", springs, SHAPES["smooth"], "depth", 0.1)
    assert start_of(sticking(bed, law, springs), state, path) is state


def test_force_and_spring_are_extrapolated_by_their_own_control() -> None:
    """The same two states lead to the same pressure by force, depth, and depth of a base."""
    here = problem("smooth", "free")
    path = steps(here, [0.08, 0.09])
    forces = [float(p.state.pressure.sum()) * here.grid.cell_area for p in path]
    bases = [p.state.depth + 0.3 * force for p, force in zip(path, forces, strict=True)]
    expected = ahead(replace(here, control=Depth(0.1)), path).pressure
    for control in (
        Force(2 * forces[1] - forces[0]),
        Depth(2 * bases[1] - bases[0], compliance=0.3),
    ):
        pressure = ahead(replace(here, control=control), path).pressure
        np.testing.assert_allclose(pressure, expected, atol=1e-10 * expected.max())


def test_extrapolated_contact_moves_with_a_periodic_surface() -> None:
    """Contact that grows across the edge of the period is extrapolated as it is elsewhere."""
    contacts = []
    for shift in (0, 21):
        here = replace(problem("rough", "periodic", shift=shift), control=Force(0.012))
        path = steps(here, [0.010, 0.011])
        contacts.append(ahead(here, path).contact)
        assert np.count_nonzero(contacts[-1]) > np.count_nonzero(path[-1].state.contact)
    np.testing.assert_array_equal(np.roll(contacts[0], 21, (0, 1)), contacts[1])


def test_extrapolated_edge_moves_as_far_as_the_edge_does() -> None:
    """On a smooth indenter the contact ahead misses at most one cell in 50; the last one in 10."""
    here = problem("smooth", "free", tension=1e-9)
    path = steps(here, [0.06, 0.08])
    answer = solve(here, SOLVER).equilibrium.contact
    cells = np.count_nonzero(answer)
    missed = np.count_nonzero(ahead(here, path).contact ^ answer) / cells
    assert missed < 0.02 < 0.1 < np.count_nonzero(path[-1].state.contact ^ answer) / cells


SIZE = 64
EVERYWHERE = np.ones((SIZE, SIZE), dtype=bool)


def disc(radius: float) -> State:
    """Return a disc that bears 2 Pa, pulled by 1 Pa up to three cells around it."""
    x = np.arange(SIZE) - (SIZE - 1) / 2
    r = np.hypot(x[:, None], x)
    wall = np.where(r < radius, 3.0, 0.0)
    return State(wall - (r < radius + 3), wall, 0.0)


def grid(boundary: Boundary, spacing: float = 1.0) -> pl.Grid:
    """Return a grid of square cells."""
    return pl.Grid(points=SIZE, size=SIZE * spacing, boundary=boundary)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
@pytest.mark.parametrize("spacing", [1.0, 1e-6])
@pytest.mark.parametrize(("radii", "ratio", "expected"), [((14, 17), 1, 20), ((20, 18), 1.5, 15)])
def test_a_disc_keeps_its_zone(
    boundary: Boundary, spacing: float, radii: tuple[int, int], ratio: float, expected: float
) -> None:
    """It grows or shrinks evenly with the zone around it, each edge to a fraction of a cell."""
    before, last = (disc(radius) for radius in radii)
    ahead = moved_on(before, last, ratio, grid(boundary, spacing), EVERYWHERE)
    radius, around = (np.sqrt(np.sum(cells) / np.pi) for cells in (ahead.contact, _pulled(ahead)))
    assert radius == pytest.approx(expected, abs=0.4)
    assert around == pytest.approx(expected + 3, abs=0.7)


def _rolled(state: State) -> State:
    return State(np.roll(state.pressure, 9, 0), np.roll(state.wall, 9, 0), 0.0)


def _pulled(state: State) -> Mask:
    return state.pressure - state.wall < -0.5


def test_a_front_crosses_the_edge_of_a_period() -> None:
    """A state that is rolled moves on as it does elsewhere, but for what an edge cuts."""
    before, last = disc(14), disc(17)
    here = moved_on(before, last, 1.0, grid("periodic"), EVERYWHERE)
    there = moved_on(_rolled(before), _rolled(last), 1.0, grid("periodic"), EVERYWHERE)
    np.testing.assert_array_equal(np.roll(here.contact, 9, 0), there.contact)


def both(one: State, other: State) -> State:
    """Return the state of two contacts."""
    return State(one.pressure + other.pressure, np.maximum(one.wall, other.wall), 0.0)


def test_only_a_single_edge_moves() -> None:
    """Patches may meet, a hole may close, and one that shrinks far may be lost."""
    full = State(np.ones((SIZE, SIZE)), np.ones((SIZE, SIZE)), 0.0)
    inside = np.where(disc(20).contact & ~disc(8).contact, 1.0, 0.0)
    two = both(State.of_pressure(np.roll(disc(6).wall, 20, 0)), disc(9))
    cases = [
        (disc(6), full),
        (disc(18), State.of_pressure(inside)),
        (State.of_pressure(inside), disc(20)),
        (disc(8), two),
        (disc(14), disc(10.5)),
        (disc(6), disc(3)),
        (disc(8), disc(12)),
    ]
    for before, last in cases:
        assert moved_on(before, last, 1.5, grid("free"), EVERYWHERE) is last


def test_a_front_stays_below_the_indenter() -> None:
    """No cell beyond a punch joins."""
    punch = disc(18.5).contact
    ahead = moved_on(disc(14), disc(17), 1.0, grid("free"), punch)
    assert ahead.contact.sum() > disc(17).contact.sum()
    np.testing.assert_array_equal(ahead.contact, punch)


def test_a_strip_moves_on_along_a_line_of_cells() -> None:
    """An axis of one cell has no front."""
    x = np.arange(SIZE)[:, None]
    before, last = (State.of_pressure(np.where(x < end, 1.0, 0.0)) for end in (20, 24))
    line = pl.Grid(points=(SIZE, 1), size=(SIZE, 1), boundary="free")
    covered = np.ones(line.shape, dtype=bool)
    assert moved_on(before, last, 1.0, line, covered).contact.sum() == 28
