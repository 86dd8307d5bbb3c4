"""Many trials at once are as each alone: tables, columns, searches; the ends they lead to."""

from __future__ import annotations

import pickle
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, Literal, NamedTuple, cast

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

import pellicle as pl
from pellicle_fit.contact.area_table import half_space
from pellicle_fit.contact.row_splines import RowSplines
from pellicle_fit.effect import Array, Contact, Effect, Solid
from pellicle_fit.estimation.intervals import End, _Way
from pellicle_fit.estimation.search import Ending, Minimum, descend
from pellicle_fit.explanation import Explanation, columns_are_rows
from tests.plugins.fit.test_effects import Soft, bead

DEEPEST = 1e-6
BODIES: dict[str, dict[str, Any]] = {
    "paraboloid": {"radius": 5e-6},
    "sphere": {"radius": 2e-6},
    "cone": {"half_angle": 1.2},
    "blunt cone": {"half_angle": 1.0, "tip_radius": 100e-9},
    "worn paraboloid": {"radius": 5e-6, "flat_radius": 0.5e-6},
    "pyramid": {"half_angle": 0.6, "sides": 4},
}


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("length", [0.0, 1e-9, 3e-8, 1.1e-7, 2e-6])
def test_a_table_of_areas(name: str, length: float) -> None:
    """It is right to 3e-6 of the largest area, in depths of five decades."""
    body: Any = pl.indenter(name.split()[-1], **BODIES[name])
    depth = np.geomspace(1e-5 * DEEPEST, DEEPEST, 301)
    exact = body.force_curve(depth, length).force
    areas = half_space(body, DEEPEST)
    error = areas(depth, length) - exact
    assert np.max(np.abs(error)) < 3e-6 * exact[-1]
    several = np.array([[length], [length], [1.1 * length + 1e-9]])
    np.testing.assert_allclose(areas(depth, several)[0], areas(depth, length), rtol=1e-12)
    found, slope = areas.slopes(depth, length)
    np.testing.assert_allclose(found[150:], exact[150:], rtol=1e-4)
    exact = body.force_curve(depth, length).by_depth
    np.testing.assert_allclose(slope[150:], exact[150:], rtol=2e-3)


def test_splines_of_rows() -> None:
    """Each is the spline of its row alone."""
    random = np.random.default_rng(1)
    nodes = np.cumsum(random.uniform(0.1, 1.0, (5, 40)), axis=1)
    values, share = random.standard_normal(nodes.shape), np.linspace(0, 1, 301)
    at = nodes[:, :1] + share * (nodes[:, -1:] - nodes[:, :1])
    each = [CubicSpline(*row)(x) for *row, x in zip(nodes, values, at, strict=True)]
    np.testing.assert_allclose(RowSplines(nodes, values)(at), each, atol=1e-13)


def test_a_contact_goes_to_another_process_without_its_tables() -> None:
    """What it knew is computed there anew."""
    body: Any = pl.indenter("paraboloid", radius=5e-6)
    contact = replace(Contact.on_half_space(body, 1e3, DEEPEST), tension=1e-3)
    depth = np.linspace(0, DEEPEST, 50)
    force, sent = contact.force(depth), pickle.dumps(contact)
    assert len(sent) < 2000
    np.testing.assert_array_equal(pickle.loads(sent).force(depth), force)


def _takes(effect: type[Effect]) -> bool:
    """Return whether an effect takes columns on a curve with both passes."""
    depth = np.linspace(-0.4e-6, 1.2e-6, 81)
    curve = bead(np.append(depth, depth[-2::-1]), stiffness=0.05)
    return columns_are_rows(Explanation(Solid(), (effect(),)), curve)


@pytest.mark.parametrize("name", sorted(pl.registry().components[Effect.family]))
def test_effects_take_columns(name: str) -> None:
    """Of columns of quantities each row is that of the numbers."""
    effect: Any = pl.registry().find(Effect.family, name)
    assert _takes(effect)


class OfNumbers(Soft):
    """What is in series takes a number alone."""

    type: Literal["of_numbers"] = "of_numbers"  # type: ignore[assignment]

    def give(self, force: Array) -> Array:
        return float(self.soft) * force


class Mixed(Soft):
    """What is in series takes columns for rows."""

    type: Literal["mixed"] = "mixed"  # type: ignore[assignment]

    def give(self, force: Array) -> Array:
        return float(np.ravel(self.soft)[0]) * force


@pytest.mark.parametrize(("effect", "takes"), [(Soft, True), (OfNumbers, False), (Mixed, False)])
def test_a_stranger_is_tried(effect: type[Effect], takes: bool) -> None:
    """Whether it takes columns is found out; one that does not is called with numbers."""
    assert _takes(effect) is takes


class Trials(NamedTuple):
    """Trials of a valley."""

    terms: Array

    def of(self, rows: NDArray[Any]) -> Trials:
        return Trials(self.terms[rows])

    def put(self, rows: NDArray[Any], others: Trials) -> None:
        self.terms[rows] = others.terms


class Valley:
    """Terms 10 (y − x²) and 1 − x, whose squares are least at (1, 1) (Rosenbrock 1960)."""

    limits = np.array([[-3.0, -3.0], [3.0, 3.0]])

    def trials(self, at: Array, near: Any = None) -> Trials:
        """Return terms; none where x is below −2.5."""
        x, y = at.T
        terms = np.column_stack([10 * (y - x**2), 1 - x])
        return Trials(np.where(x[:, None] < -2.5, np.nan, terms))

    def derivatives(self, at: Array, trials: Trials) -> Array:
        x = at[:, 0]
        rows = [[-20 * x, np.full_like(x, -1.0)], [np.full_like(x, 10.0), 0 * x]]
        return np.moveaxis(np.array(rows), 2, 0)

    def squares(self, terms: Array) -> tuple[float, ...]:
        return (float(terms @ terms),)


STARTS = np.array([[-1.2, 1.0], [2.0, 2.0], [-2.9, 0.0], [0.3, -1.0]])


def test_a_search_ends_at_the_minimum() -> None:
    """Those that start where there is a force; the others stay, and are infinite."""
    found = descend(Valley(), STARTS, fall=1e-12)
    for k in (0, 1, 3):
        np.testing.assert_allclose(found[k].at, 1.0, atol=1e-4)
    assert not np.isfinite(found[2].chi_squared)
    assert [one.ending is Ending.UNBALANCED for one in found] == [False, False, True, False]
    assert sum(one.ending is Ending.CONVERGED for one in found) == 3


def test_a_search_keeps_what_is_held_and_the_limits() -> None:
    """With x held y is x², within its limits; with x at most 0.5 the least is there."""
    held = np.zeros(STARTS.shape, dtype=bool)
    held[:, 0] = True
    for one, start in zip(descend(Valley(), STARTS, held), STARTS, strict=True):
        if np.isfinite(one.chi_squared):
            np.testing.assert_allclose(one.at, [start[0], min(start[0] ** 2, 3.0)], atol=1e-4)
    narrow = Valley()
    narrow.limits = np.array([[-2.0, -3.0], [0.5, 3.0]])
    (one,) = descend(narrow, STARTS[3:], fall=1e-12)
    np.testing.assert_allclose(one.at, [0.5, 0.25], atol=1e-4)
    assert np.isclose(one.chi_squared, 0.25)


def test_a_search_that_cannot_come_below_its_goal_is_given_up() -> None:
    """It says so, and its χ² is an upper bound; a goal within reach is none to give up."""
    (one,) = descend(Valley(), STARTS[:1], goal=-1.0)
    assert one.ending is Ending.GIVEN_UP
    assert one.chi_squared > 0
    (one,) = descend(Valley(), STARTS[:1], goal=1.0)
    assert one.ending is Ending.CONVERGED
    assert one.chi_squared < 1e-4


def test_end_where_chi_squared_jumps() -> None:
    """Where two searches find χ² on both sides of the end at one place, that is the end."""
    quantity = SimpleNamespace(log=False)
    slot = SimpleNamespace(quantity=quantity, value=lambda at: float(at))
    objective = SimpleNamespace(slots=[slot], limits=np.array([[-10.0], [10.0]]))
    at = np.zeros(1)

    def minimum(chi_squared: float) -> Minimum:
        found = SimpleNamespace(at=at, chi_squared=chi_squared)
        return cast("Minimum", found)

    way = _Way(cast("Any", objective), minimum(0.0), np.ones((4, 1)), 0, 1, 4.0)
    here = way.distance
    way.advance(minimum(100.0))
    assert way.distance < here
    # Searches of two starts disagree about one point.
    way.distance = here
    way.advance(minimum(0.0))
    assert way.is_done
    assert way.kind is End.CLOSED
    assert way.end == pytest.approx(here)
