"""Solves take the operator applications that they took, within a fifth."""

from __future__ import annotations

import pytest

from tests.physics.frozen.benchmarks import CASES, Case
from tests.physics.frozen.comparison import COUNT_TOLERANCE
from tests.physics.frozen.store import stored

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


def test_all_that_is_stored_is_compared() -> None:
    """Each stored count has its case."""
    assert COUNTS.keys() == {case.name for case in CASES}
