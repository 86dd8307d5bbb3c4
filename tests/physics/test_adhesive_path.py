"""The path of a contact that sticks: its steps, and their starts. Units are E* = R = w = 1."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
import xarray as xr

from pellicle.contact import load_step
from pellicle.contact.load_step import end_of
from pellicle.contact.moved_front import moved_on
from pellicle.contact.solution import State
from pellicle.results.record import Steps
from tests.adhesive_paths import solved

# In these units slopes are large.
pytestmark = pytest.mark.filterwarnings("ignore::pellicle.ConvergenceWarning")


@cache
def path() -> xr.Dataset:
    """Return a path of three steps, of 32 x 32 cells."""
    return solved(32, 1.0, (0.1, 0.3, 0.5))


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
    run = path()
    done = Steps(3)
    for index in range(3):
        step = run.isel(step=[index])
        done.append(step.assign({name: ("step", [value])}) if index == at else step)
    return len(end_of(done.path))


def test_a_front_that_was_moved_past_a_barrier_goes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """A contact that is pulled stays on its path, from wherever a step has started.

    From four cells a descent ends without contact where the path has one of over 100.
    """
    starts: dict[str, Callable[..., State]] = {
        "last": lambda before, last, *_: last,
        "moved": moved_on,
        "lost": lambda before, last, *_: _four_cells(last),
    }
    runs = {}
    for name, start in starts.items():
        monkeypatch.setattr(load_step, "moved_on", start)
        runs[name] = solved(32, 0.0, (0.3, 0.2, 0.05, -0.1))
    cells = runs["last"]["contact"].sum(("x", "y")).values
    assert cells[-1] > 100
    for name in ("moved", "lost"):
        assert not runs[name]["jumped"][1:].any()
        np.testing.assert_allclose(runs[name]["energy"], runs["last"]["energy"], rtol=1e-6)


def _four_cells(last: State) -> State:
    middle = slice(last.wall.shape[0] // 2 - 1, last.wall.shape[0] // 2 + 1)
    wall = np.zeros(last.wall.shape)
    wall[middle, middle] = last.wall[middle, middle]
    return State(wall, wall, last.depth)
