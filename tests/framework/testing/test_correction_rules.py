"""For each rule of corrections: a correction that breaks it, and only it, by a little."""

from typing import Any, Literal

import numpy as np
import pytest

from tests.framework.testing.mutants import base, check_base, check_mutant, rules_of

Yastrebov: Any = base("correction", "yastrebov")


class Correction(Yastrebov):
    """Correction to be broken."""

    type: Literal["broken"] = "broken"


class Several(Correction):
    """An area for each row."""

    def area(self, contact: Any, spacing: Any) -> Any:
        return contact.sum(axis=1) * spacing[0] * spacing[1]


class Filling(Correction):
    """Marks cells of its caller's."""

    def area(self, contact: Any, spacing: Any) -> Any:
        contact[20:25, 10:15] = True
        return super().area(contact, spacing)


class Floor(Correction):
    """Never less than one cell."""

    def area(self, contact: Any, spacing: Any) -> Any:
        return max(super().area(contact, spacing), spacing[0] * spacing[1])


class Overall(Correction):
    """One per cent off, boundary or not."""

    def area(self, contact: Any, spacing: Any) -> Any:
        return 0.99 * super().area(contact, spacing)


class Excessive(Correction):
    """Takes off ten times too much."""

    def area(self, contact: Any, spacing: Any) -> Any:
        count = np.count_nonzero(contact) * spacing[0] * spacing[1]
        return count - 30 * (count - super().area(contact, spacing))


class Unscaled(Correction):
    """Takes off cells of a size that it knows."""

    def area(self, contact: Any, spacing: Any) -> Any:
        cell = spacing[0] * spacing[1]
        return super().area(contact, spacing) - 1e-12 * (0 < contact.mean() < 1) * (cell > 1e-12)


class Skewed(Correction):
    """Sees boundaries across x only."""

    def area(self, contact: Any, spacing: Any) -> Any:
        cell = spacing[0] * spacing[1]
        switches = np.count_nonzero(contact[1:] != contact[:-1])
        return cell * (np.count_nonzero(contact) - 0.1 * switches)


class Seamed(Correction):
    """Takes the edge of a periodic domain for a border."""

    def periodic_area(self, contact: Any, spacing: Any) -> float:
        return float(self.area(contact, spacing))


class Microscopic(Correction):
    """Sees nothing of cells wider than 30 µm."""

    def area(self, contact: Any, spacing: Any) -> Any:
        return super().area(contact, spacing) if spacing[0] < 3e-5 else 0.0


class Wordy(Correction):
    """Says the area in words."""

    def area(self, contact: Any, spacing: Any) -> Any:
        return f"{super().area(contact, spacing)} m²"


class Lost(Correction):
    """Does not know the area."""

    def area(self, contact: Any, spacing: Any) -> Any:
        return np.nan


class Failing(Correction):
    """Says −1 for no contact, as C programs do."""

    def area(self, contact: Any, spacing: Any) -> Any:
        return super().area(contact, spacing) if contact.any() else -1


CORRECTIONS = {
    Wordy: "area_is_pure",
    Lost: "area_is_pure",
    Failing: "no_contact_has_no_area",
    Several: "area_is_pure",
    Filling: "area_is_pure",
    Floor: "no_contact_has_no_area",
    Overall: "full_contact_is_the_domain",
    Excessive: "area_is_near_the_count",
    Unscaled: "area_scales_with_the_cells",
    Skewed: "area_does_not_depend_on_the_view",
    Seamed: "periodic_area_has_no_seam",
    Microscopic: "goes_into_the_result",
}


@pytest.mark.parametrize(
    ("mutant", "rule"), CORRECTIONS.items(), ids=lambda value: getattr(value, "__name__", "")
)
def test_mutant_is_caught(mutant: Any, rule: str) -> None:
    """The message names the class, the rule, what is asked and what was found."""
    check_mutant("correction", mutant(), rule)


def test_what_the_mutants_are_made_of_is_whole() -> None:
    """Without its fault each mutant breaks nothing but that no plugin registers it."""
    check_base("correction", Correction())


def test_each_rule_has_a_mutant(monkeypatch: pytest.MonkeyPatch) -> None:
    """No rule could be dropped, or say yes to everything, without a test that fails."""
    assert rules_of("correction", monkeypatch) == set(CORRECTIONS.values())
