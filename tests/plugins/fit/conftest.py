"""What tests of fits share: the command, fits without rivals, and the ends of intervals."""

from functools import partial

import pytest

import pellicle as pl
from tests.command import Cli
from tests.shared_fits import share_fits, skip_rivals


@pytest.fixture
def cli(cli: Cli) -> Cli:
    """Return a function that calls ``pellicle fit`` in an empty folder and checks its exit code."""
    return partial(cli, "fit")


@pytest.fixture
def no_rivals(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let fits of a test skip rivals."""
    skip_rivals(monkeypatch)


@pytest.fixture
def shared_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let fits of a test have the result of an earlier one of an equal problem."""
    share_fits(monkeypatch)


def ends_of(estimate: pl.Estimate | None) -> tuple[float, float]:
    """Return both ends of an interval that is closed."""
    assert estimate is not None
    assert estimate.low is not None
    assert estimate.high is not None
    return estimate.low, estimate.high


def holds(estimate: pl.Estimate | None, truth: float) -> bool:
    """Return whether an interval, which is closed, holds the truth."""
    low, high = ends_of(estimate)
    return low <= truth <= high
