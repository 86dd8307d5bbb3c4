"""The front of a contact that sticks moves on as it moved last."""

from __future__ import annotations

import numpy as np
import pytest

import pellicle as pl
from pellicle.arrays import Mask
from pellicle.contact.moved_front import moved_on
from pellicle.contact.solution import State
from pellicle.grid import Boundary

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
