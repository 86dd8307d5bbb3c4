"""For each rule of interactions: an interaction that breaks it, and only it."""

from typing import Any, ClassVar, Literal

import numpy as np
import pytest

from pellicle.components import Kernel
from pellicle.grid import Grid
from tests.framework.testing.mutants import base, check_base, check_mutant, rules_of

Linear: Any = base("interaction", "linear")
FIELDS = {"work_of_adhesion": 0.05, "range": 2e-6}


class Law(Linear):
    """Linear softening to be broken."""

    type: Literal["broken"] = "broken"


class Endless(Law):
    """Acts at every gap."""

    def cutoff(self) -> float:
        return np.inf


class Summed(Law):
    """Returns the mean energy of all gaps."""

    def energy(self, gap: Any) -> Any:
        return np.full(gap.shape, super().energy(gap).mean())


class Listed(Law):
    """Returns a list."""

    def traction(self, gap: Any) -> Any:
        return super().traction(gap).tolist()


class Halving(Law):
    """Changes its argument."""

    def energy(self, gap: Any) -> Any:
        values = super().energy(gap)
        gap *= 0.5
        return values


class Tired(Law):
    """Pulls less with every call."""

    calls: ClassVar[list[int]] = []

    def traction(self, gap: Any) -> Any:
        self.calls.append(1)
        return super().traction(gap) * (1 - 1e-15 * len(self.calls))


class Undefined(Law):
    """Has no slope at a closed gap."""

    def slope(self, gap: Any) -> Any:
        return np.where(gap > 0, super().slope(gap), np.nan)


class Positive(Law):
    """Counts the energy from the other side."""

    def energy(self, gap: Any) -> Any:
        return super().energy(gap) + self.work_of_adhesion


class Late(Law):
    """Is strongest in the middle of its range."""

    def traction(self, gap: Any) -> Any:
        share = gap / self.range
        return -6 * self.work_of_adhesion / self.range * np.clip(share * (1 - share), 0, None)

    def energy(self, gap: Any) -> Any:
        share = np.clip(gap / self.range, 0, 1)
        return self.work_of_adhesion * (3 * share**2 - 2 * share**3 - 1)


class Lasting(Law):
    """Ends at half its range."""

    def cutoff(self) -> float:
        return float(super().cutoff()) / 2


class Repels(Law):
    """Pulls up to its range, and pushes there."""

    def traction(self, gap: Any) -> Any:
        return super().traction(gap) + 1e-3 * self.greatest_traction * (gap > 0.9 * self.range)


class Doubled(Law):
    """Pulls twice as much as the energy says."""

    def traction(self, gap: Any) -> Any:
        return 2 * super().traction(gap)

    def slope(self, gap: Any) -> Any:
        return 2 * super().slope(gap)


class Exchanged(Law):
    """Has the traction of another law with the same work of adhesion."""

    def traction(self, gap: Any) -> Any:
        return np.where(gap < self.range, -self.work_of_adhesion / self.range, 0.0)


class Slack(Law):
    """Has the slope of another law."""

    def slope(self, gap: Any) -> Any:
        return 0.9 * super().slope(gap)


class Weaker(Law):
    """Has less work of adhesion on a grid."""

    def resolved(self, kernel: Kernel, grid: Grid) -> Any:
        return Law(work_of_adhesion=0.99 * self.work_of_adhesion, range=self.range)


class Choosy(Law):
    """Cannot be resolved on some grids."""

    def resolved(self, kernel: Kernel, grid: Grid) -> Any:
        return self if grid.shape[0] in (16, 256) else None


MUTANTS = {
    Endless: "cutoff_is_a_length",
    Positive: "closed_gap_attracts",
    Late: "closed_gap_attracts",
    Undefined: "values_are_finite",
    Summed: "values_are_vectorised",
    Listed: "values_are_vectorised",
    Halving: "functions_leave_their_argument",
    Tired: "functions_leave_their_argument",
    Lasting: "energy_rises_to_nothing",
    Repels: "attraction_falls_with_the_gap",
    Doubled: "rigid_sphere_is_pulled_by_2_pi_w_r",
    Exchanged: "traction_is_the_derivative_of_the_energy",
    Slack: "slope_is_the_derivative_of_the_traction",
    Weaker: "resolved_keeps_the_work_of_adhesion",
    Choosy: "run_under_a_pull_converges",
}


@pytest.mark.parametrize(
    ("mutant", "rule"), MUTANTS.items(), ids=lambda value: getattr(value, "__name__", "")
)
def test_mutant_is_caught(mutant: Any, rule: str) -> None:
    """The message names the class, the rule, what is asked and what was found."""
    check_mutant("interaction", mutant(**FIELDS), rule)


def test_what_the_mutants_are_made_of_is_whole() -> None:
    """Without its fault each mutant breaks nothing but that no plugin registers it."""
    check_base("interaction", Law(**FIELDS))


def test_each_rule_has_a_mutant(monkeypatch: pytest.MonkeyPatch) -> None:
    """No rule could be dropped, or say yes to everything, without a test that fails."""
    assert rules_of("interaction", monkeypatch) == set(MUTANTS.values())
