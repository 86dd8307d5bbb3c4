"""For each rule of prescriptions: a prescription that breaks it, and only it."""

from typing import Any, ClassVar, Literal

import numpy as np
import pytest

import pellicle as pl
from tests.framework.testing.mutants import base, check_base, check_mutant, rules_of

GapVolume: Any = base("prescription", "gap_volume")


class Volume(GapVolume):
    """Gap volume to be broken."""

    type: Literal["broken"] = "broken"
    variables: ClassVar[Any] = (
        GapVolume.variables[0]._replace(name="broken"),
        GapVolume.variables[1],
    )

    def report(self, setting: Any, step: Any) -> dict[str, float]:
        return {"broken": super().report(setting, step)["gap_volume"]}


class Undeclared(Volume):
    """Reports under a name that it does not declare."""

    def report(self, setting: Any, step: Any) -> dict[str, float]:
        return super().report(setting, step) | {"other": 1.0}


class Wordy(Volume):
    """Reports in words."""

    def report(self, setting: Any, step: Any) -> Any:
        return {"broken": "about 1 mm³"}


class Fickle(Volume):
    """Searches for another volume every time."""

    count: ClassVar[list[int]] = []

    def target(self, setting: Any, value: float) -> Any:
        self.count.append(1)
        return super().target(setting, value * (1 + 1e-9 * len(self.count)))


class Lost(Volume):
    """Does not know the goal."""

    def target(self, setting: Any, value: float) -> Any:
        return pl.Force(np.nan)


class Naked(Volume):
    """Returns a number."""

    def target(self, setting: Any, value: float) -> Any:
        return value


class Divides(Volume):
    """Knows no zero."""

    def target(self, setting: Any, value: float) -> Any:
        return super().target(setting, 1 / (1 / value))


class Upwards(Volume):
    """Searches for the volume itself, which falls as the force grows."""

    def target(self, setting: Any, value: float) -> Any:
        search = super().target(setting, value)
        cell = setting.grid.cell_area
        return pl.Search(value, lambda step: float(step.gap.sum()) * cell, guess=search.guess)


class Half(Volume):
    """Means twice the volume."""

    def target(self, setting: Any, value: float) -> Any:
        return super().target(setting, min(0.6 * value, value))


MUTANTS = {
    Undeclared: "report_is_as_declared",
    Wordy: "report_is_as_declared",
    Fickle: "target_is_pure",
    Lost: "target_is_pure",
    Naked: "target_is_pure",
    Divides: "values_are_refused_in_words",
    Upwards: "search_does_not_fall",
    Half: "step_has_what_is_prescribed",
}


@pytest.mark.parametrize(
    ("mutant", "rule"), MUTANTS.items(), ids=lambda value: getattr(value, "__name__", "")
)
def test_mutant_is_caught(mutant: Any, rule: str) -> None:
    """The message names the class, the rule, what is asked and what was found."""
    check_mutant("prescription", mutant(), rule)


def test_what_the_mutants_are_made_of_is_whole() -> None:
    """Without its fault each mutant breaks nothing but that no plugin registers it."""
    check_base("prescription", Volume())


def test_each_rule_has_a_mutant(monkeypatch: pytest.MonkeyPatch) -> None:
    """No rule could be dropped, or say yes to everything, without a test that fails."""
    assert rules_of("prescription", monkeypatch) == set(MUTANTS.values())
