"""Steps of a contact that sticks, started from the last two: the same path in fewer applications.

Units are E* = R = w = 1, depths in a₀²/R.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle.components import Setting
from pellicle.contact.front import Traction, same_patches, shifted
from pellicle.contact.problem import Depth
from pellicle.contact.start import PathPoint, Start, start_of
from pellicle.results.step import Steps
from pellicle.runs import steps
from pellicle.runs.compose import compose
from pellicle.runs.following import followed
from pellicle_plugins.solvers.active_set import ActiveSet
from tests.adhesive_paths import FORCE, JKR, PARABOLOID, half_space, solved

DOWN = [0.1, 0.3, 0.5, 0.7]
BACK = [0.5, 0.3]
# In these units slopes are large.
pytestmark = pytest.mark.filterwarnings("ignore::pellicle.ConvergenceWarning")


def from_last_state_alone(self: Setting, problem: pl.Problem) -> pl.State | None:
    """Return the start of a step as it is without extrapolation."""
    return self.state


@cache
def path(extrapolated: bool, depths: tuple[float, ...], length: float = 1.0) -> xr.Dataset:
    """Return a path of 64 x 64 cells, with or without extrapolated starts, and no error of it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(steps, "force_limit", lambda *_: None)
        if not extrapolated:
            patch.setattr(Setting, "start", from_last_state_alone)
        return solved(64, length, depths)


def test_path_is_the_same_in_fewer_applications() -> None:
    """Forces agree to 1e-4 πwR, contacts to a cell in 500; steps with two states before cost less.

    Measured: 32, 41, 42 applications instead of 44, 45, 48. The first two steps and the one at
    which the path turns have one state and cost the same.
    """
    depths = tuple(DOWN + BACK)
    one, two = path(False, depths), path(True, depths)
    assert one["converged"].all()
    assert two["converged"].all()
    np.testing.assert_allclose(two["force"], one["force"], atol=1e-4 * FORCE)
    missed = (one["contact"] ^ two["contact"]).sum(["x", "y"])
    assert (missed <= one["contact"].sum(["x", "y"]) / 500).all()
    used = [run["operator_applications"].values for run in (one, two)]
    alone = [0, 1, len(DOWN)]
    np.testing.assert_array_equal(used[1][alone], used[0][alone])
    ahead = np.delete(np.arange(len(depths)), alone)
    assert used[1][ahead].mean() < 0.9 * used[0][ahead].mean()


@pytest.mark.slow
def test_jumps_where_the_last_state_does() -> None:
    """A retraction loses its contact at the same step, from states extrapolated up to there."""
    depths = (0.1, -0.4, -0.7, -0.9, -1.1)
    one, two = path(False, depths), path(True, depths)
    assert 0 < np.count_nonzero(one["contact_area"]) < len(depths)
    for name in ("jumped", "status_code"):
        assert two[name].values.tolist() == one[name].values.tolist(), name
    np.testing.assert_allclose(two["force"], one["force"], atol=1e-4 * FORCE)


def retraction_to(depth: float, interaction: dict[str, Any]) -> pl.Run:
    """Return a step of a paraboloid that sticks."""
    return pl.Run(
        grid={"points": 64, "size": 5.0},
        kernel=half_space(0.0),
        indenter=PARABOLOID,
        interaction=interaction,
        loading={"depth": [depth]},
    )


@cache
def case() -> Case:
    """Return two steps of a retraction, and the next."""
    return Case(-0.9, -1.0, -1.1)


@pytest.mark.parametrize(("name", "at", "number"), [("jumped", 2, 1), ("jumped", 1, 2)])
def test_steps_before_a_jump_are_left_out(name: str, at: int, number: int) -> None:
    """The state after a jump is the first of a new path."""
    assert _points(name, at, True) == number
    assert _points(name, at, False) == 2


@pytest.mark.parametrize(("at", "number"), [(2, 0), (1, 1), (0, 2)])
def test_steps_that_did_not_converge_are_left_out(at: int, number: int) -> None:
    """A state that is not an equilibrium says nothing of the path."""
    assert _points("converged", at, False) == number


def _points(name: str, at: int, value: bool) -> int:
    """Return how many of three steps remain, of which one has another value of a flag."""
    run = path(True, tuple(DOWN + BACK))
    done = Steps(3)
    for index in range(3):
        step = run.isel(step=[index])
        done.append(step.assign({name: ("step", [value])}) if index == at else step)
    return len(done.path)


class Case:
    """Two steps of a path at depths below 0, of which the first may be replaced by another."""

    def __init__(self, first: float, last: float, following: float) -> None:
        self.run = retraction_to(following, JKR)
        self.solver = ActiveSet(tolerance=1e-8)
        self.setting = compose(self.run)
        self.problem = self.setting.problem(Depth(following))
        start = self._solved(0.1, None)
        self.points = (self._solved(first, start), self._solved(last, start))

    def _solved(self, depth: float, before: PathPoint | None) -> PathPoint:
        here = replace(self.setting, state=before.state if before else None)
        problem = self.setting.problem(Depth(depth))
        _, equilibrium = followed(here, self.solver, problem, lambda *_: None)
        return PathPoint(equilibrium.state, equilibrium.gap, equilibrium.energy)

    def start(self, points: tuple[PathPoint, ...]) -> pl.State | None:
        """Return the start from two points."""
        return start_of(self.problem, points[-1].state, points)

    def force(self, points: tuple[PathPoint, ...]) -> float:
        """Return the force over πwR from two points."""
        here = replace(self.setting, state=points[-1].state, path=points)
        _, equilibrium = followed(here, self.solver, self.problem, lambda *_: None)
        return equilibrium.force / FORCE


@pytest.mark.parametrize("size", [0.5, 1.5])
def test_wrong_extrapolation_does_not_change_the_answer(size: float) -> None:
    """A start with a contact of half or half again the radius ends on the path of the last state.

    Without the guard both pull off: what the indenter presses with does not fit the contact.
    """
    near = case()
    right = near.force((near.points[-1],))
    start = near.start(near.points)
    assert isinstance(start, Start)
    assert start.ahead
    x, y = near.run.grid.coordinates()
    radius = np.sqrt(np.count_nonzero(start.contact) * near.run.grid.cell_area / np.pi)
    inside = np.hypot(x - x.mean(), y - y.mean()) < size * radius
    wall = np.where(inside, float(start.wall.max()), 0.0)
    wrong = Start.of(pl.State(*start), pl.State(wall, wall, start.depth))
    here = replace(near.setting, state=start, path=near.points)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Setting, "start", lambda *_: wrong)
        _, equilibrium = followed(here, near.solver, near.problem, lambda *_: None)
    assert equilibrium.force / FORCE == pytest.approx(right, abs=1e-4)
    assert near.force(near.points) == pytest.approx(right, abs=1e-4)


def test_solver_that_ignores_the_extrapolation_is_asked_once() -> None:
    """A solution that jumps is only solved for again if it began from the extrapolation."""
    near = case()
    calls: list[pl.State | None] = []

    class Plain(ActiveSet):
        """A solver that starts from the state alone, and loses the contact."""

        def solve(self, problem: pl.Problem, start: pl.State | None, monitor: Any) -> pl.Solution:
            """Return no contact."""
            calls.append(start)
            nothing = np.zeros(problem.grid.shape)
            return pl.Solution(pl.State(nothing, nothing, problem.value), 1)

    here = replace(near.setting, state=near.points[-1].state, path=near.points)
    followed(here, Plain(), near.problem, lambda *_: None)
    assert len(calls) == 1


def test_nothing_is_extrapolated_across_a_jump_or_by_a_law_of_its_own_range() -> None:
    """After a jump two states say nothing of the next, nor with a law that acts before contact."""
    near = case()
    first, last = near.points
    moved = first.state._replace(
        pressure=np.roll(first.state.pressure, 30, 0), wall=np.roll(first.state.wall, 30, 0)
    )
    far = start_of(near.problem, last.state, (first._replace(state=moved), last))
    assert not isinstance(far, Start)
    dugdale = {"type": "dugdale", "work_of_adhesion": 1.0, "strength": 1.0}
    problem = compose(retraction_to(-1.1, dugdale)).problem(Depth(-1.1))
    assert not isinstance(start_of(problem, last.state, near.points), Start)


def disc(grid: pl.Grid, radius: float, centre: float = 0.0) -> Traction:
    """Return a disc around a centre on the diagonal, whose traction falls over two cells."""
    x, y = grid.coordinates()
    edges = [np.abs(part - part.mean() - centre) for part in (x, y)]
    if grid.boundary == "periodic":
        edges = [np.minimum(part, 1 - part) for part in edges]
    distance = np.hypot(*edges) - radius
    across = -np.clip(1 - distance / (2 * grid.cell_size), 0.0, 1.0)
    wall = np.where(distance < 0, -10.0 * distance, 0.0)
    return Traction(distance < 0, wall, across)


@pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("growth", [0.002, 0.03, -0.03])
def test_front_moves_on_by_as_much(growth: float, ratio: float) -> None:
    """A disc whose radius grew goes on to grow: its radius is met to 0.3 cells."""
    grid = pl.Grid(points=128, size=1.0)
    ahead = shifted(grid, disc(grid, 0.2), disc(grid, 0.2 + growth), ratio)
    radius = 0.2 + growth * (1 + ratio)
    exact = disc(grid, radius)
    missed = np.count_nonzero(ahead.contact ^ exact.contact)
    assert missed < 0.6 * 2 * np.pi * radius * 128
    assert np.sqrt(np.count_nonzero(ahead.contact) / np.pi) / 128 == pytest.approx(
        radius, abs=0.3 / 128
    )
    deep = exact.wall > 0.5
    np.testing.assert_allclose(ahead.wall[deep], exact.wall[deep], atol=0.15)


def test_front_moves_across_the_edge_of_a_period() -> None:
    """A disc in the corner of a periodic grid moves as one in its middle."""
    grid = pl.Grid(points=64, size=1.0, boundary="periodic")
    middle, corner = (
        shifted(grid, disc(grid, 0.2, place), disc(grid, 0.23, place), 1.0) for place in (0.0, 0.5)
    )
    np.testing.assert_array_equal(np.roll(middle.contact, 32, (0, 1)), corner.contact)
    across = np.roll(middle.across, 32, (0, 1))
    near = across != 0
    np.testing.assert_allclose(corner.across[near], across[near], atol=1e-9)


def test_patches_that_come_go_split_or_merge_are_told() -> None:
    """Two sets of patches are the same only if each patch of one meets one of the other.

    A cell across a corner belongs to its patch: an averaged law gives such cells a traction.
    """
    two = np.zeros((12, 12), dtype=bool)
    two[2:5, 2:5] = two[7:10, 2:5] = True
    grown, merged, fewer, more = two.copy(), two.copy(), two.copy(), two.copy()
    grown[2:5, 5] = grown[5, 6] = True
    merged[5:7, 3] = True
    fewer[7:10] = False
    more[7:10, 8:10] = True
    assert same_patches(two, grown, "free")
    assert not any(same_patches(two, other, "free") for other in (merged, fewer, more))
    assert not any(same_patches(other, two, "free") for other in (merged, fewer, more))
