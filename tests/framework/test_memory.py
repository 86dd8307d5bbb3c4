"""The estimate of memory before a run."""

from __future__ import annotations

import math

import pytest

import pellicle as pl
from pellicle import memory


def _grid(points: int, boundary: str = "free") -> pl.Grid:
    return pl.Grid(points=points, size=1.0, boundary=boundary)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_estimate_grows_with_cells_and_steps(boundary: str) -> None:
    """Twice the points take four times the memory, and steps that are kept take more."""
    small = memory.estimate(_grid(64, boundary), 1)
    assert memory.estimate(_grid(128, boundary), 1) == pytest.approx(4 * small)
    assert memory.estimate(_grid(64, boundary), 10) > 2 * small


def test_estimate_holds_at_least_the_result() -> None:
    """The estimate is over what the result alone takes: three fields and a flag of each step."""
    assert memory.estimate(_grid(100, "periodic"), 7) > 7 * 100**2 * (3 * 8 + 1)


def test_free_takes_more_than_periodic() -> None:
    """The zero padding of a free boundary is counted."""
    assert memory.estimate(_grid(64), 1) > memory.estimate(_grid(64, "periodic"), 1)


def test_estimate_does_not_overflow() -> None:
    """A number of points beyond floats needs an infinite amount."""
    assert memory.estimate(_grid(10**400), 1) == math.inf


def test_require(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that does not fit is refused, one that fits or on a machine that is silent is not."""
    needed = memory.estimate(_grid(64), 1)
    monkeypatch.setattr(memory, "available", lambda: needed * 0.99)
    with pytest.raises(pl.ConfigError, match=r"grid\.points: 64 × 64 with 1 step needs about"):
        memory.require(_grid(64), 1)
    monkeypatch.setattr(memory, "available", lambda: needed * 1.01)
    memory.require(_grid(64), 1)
    monkeypatch.setattr(memory, "available", lambda: None)
    memory.require(_grid(64), 1)


def test_available() -> None:
    """What this machine says it has is a sensible amount, if it says anything."""
    there = memory.available()
    assert there is None or 1e6 < there < 1e15
