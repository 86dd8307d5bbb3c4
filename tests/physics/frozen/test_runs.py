"""Runs have the values that they had, to 100 times their tolerance, and solves the applications."""

from functools import cache
from typing import Any

import numpy as np
import pytest

from tests.physics.frozen.benchmarks import CASES, Case
from tests.physics.frozen.comparison import COUNT_TOLERANCE, changes, compact
from tests.physics.frozen.configurations import CONFIGURATIONS, RESUMED
from tests.physics.frozen.reader import run_values
from tests.physics.frozen.store import stored

RUNS = stored("runs")
SLOW = (
    "prescribed area",
    "prescribed radius",
    "cone on coated layers",
    "jkr, pulled by a force",
)
AGAIN = "; if that is right: python tests/physics/frozen/record.py runs"


@cache
def values_of(name: str) -> dict[str, Any]:
    """Return the values of a run that is not interrupted."""
    return run_values(CONFIGURATIONS[name])


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[pytest.mark.slow] if n in SLOW else []) for n in CONFIGURATIONS],
)
def test_run(name: str) -> None:
    """A run gives what is stored."""
    run = RUNS[name]
    told = changes(run["values"], compact(values_of(name)), run["tolerance"])
    assert not told, f"{told}{AGAIN}"


@pytest.mark.parametrize("name", RESUMED)
def test_resumed_run(name: str) -> None:
    """A run that is interrupted after two steps and resumed is bit by bit one that is not."""
    whole = values_of(name)
    resumed = run_values(CONFIGURATIONS[name], interrupted_after=2)
    assert whole.keys() == resumed.keys()
    for variable, values in whole.items():
        np.testing.assert_array_equal(resumed[variable], values, err_msg=variable)


def test_all_that_is_stored_is_compared() -> None:
    """Each stored run has its configuration."""
    assert RUNS.keys() == CONFIGURATIONS.keys()


COUNTS = stored("applications")


@pytest.mark.parametrize(
    "case",
    [pytest.param(c, id=c.name, marks=[pytest.mark.slow] if c.slow else []) for c in CASES],
)
def test_applications(case: Case) -> None:
    """A case takes as many as are stored."""
    count, kept = case.applications(), COUNTS[case.name]
    assert abs(count - kept) <= COUNT_TOLERANCE * kept, (
        f"{kept} → {count}; if that is right: python tests/physics/frozen/record.py applications"
    )


def test_all_counts_that_are_stored_are_compared() -> None:
    """Each stored count has its case."""
    assert COUNTS.keys() == {case.name for case in CASES}
