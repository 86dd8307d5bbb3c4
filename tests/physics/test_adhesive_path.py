"""Which finished steps of a contact that sticks count as its path. Units are E* = R = w = 1."""

from __future__ import annotations

from functools import cache

import pytest
import xarray as xr

from pellicle.contact.load_step import end_of
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
