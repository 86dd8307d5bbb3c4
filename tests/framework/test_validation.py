"""Cases of known solution that cannot be compared: each fails alone, and says why."""

from __future__ import annotations

import math
from collections.abc import Callable
from unittest.mock import Mock

import pytest

import pellicle as pl
from pellicle.runs import runner, validation
from tests.command import call
from tests.small_run import RUN


def case(name: str, computed: Callable[[pl.Result], float], expected: float = 1.0) -> pl.Case:
    """Return a case about the small run."""
    return pl.Case(name, RUN, computed, expected, "N", 1e-3, "Hertz 1882")


def test_a_case_that_raises_fails_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the function of a case raises is the problem of this case, and the rest is checked."""
    cases = [
        case("lost", lambda result: result.dataset["load"].item()),
        case("good", lambda result: 1.0),
    ]
    lost, good = validation.validate(cases)
    assert (lost.passed, good.passed) == (False, True)
    assert lost.problem.startswith("KeyError: ")
    assert math.isnan(lost.computed)
    monkeypatch.setattr(validation, "validate", lambda: iter((lost, good)))
    shown = call("validate", code=1)
    assert "FAILED KeyError: " in shown.stdout
    assert "1 of 2 cases failed" in shown.stdout


def test_cases_in_a_row_share_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """A configuration is solved once for all cases about it that follow each other."""
    solve = Mock(side_effect=runner.solve)
    monkeypatch.setattr(validation, "solve", solve)
    checked = validation.validate(case(name, lambda result: 1.0) for name in "abc")
    assert [one.case.name for one in checked] == ["a", "b", "c"]
    solve.assert_called_once()


def test_a_case_expects_a_value_with_a_relative_error() -> None:
    """A true value of 0 is refused where the case is made."""
    with pytest.raises(pl.ConfigError, match="expected: 0 has no relative error"):
        case("nothing", lambda result: 0.0, expected=0.0)
