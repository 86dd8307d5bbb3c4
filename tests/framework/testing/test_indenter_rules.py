"""For each rule of indenters: an indenter that breaks it, and only it, by a little."""

from typing import Any, ClassVar, Literal

import numpy as np
import pytest

from tests.framework.testing.mutants import base, check_base, check_mutant, rules_of

Paraboloid: Any = base("indenter", "paraboloid")


class Indenter(Paraboloid):
    """Paraboloid to be broken."""

    type: Literal["broken"] = "broken"


class Flattened(Indenter):
    """Heights in a row."""

    def profile(self, x: Any, y: Any) -> Any:
        return super().profile(x, y).ravel()


class Raised(Indenter):
    """Heights upwards."""

    def profile(self, x: Any, y: Any) -> Any:
        return -super().profile(x, y)


class Gone(Indenter):
    """No indenter anywhere."""

    def profile(self, x: Any, y: Any) -> Any:
        return np.full(np.broadcast(x, y).shape, -np.inf)


class Moving(Indenter):
    """Shifts the points of its caller."""

    def profile(self, x: Any, y: Any) -> Any:
        values = super().profile(x, y)
        x -= 1e-6
        return values


class Random(Indenter):
    """Another roughness at each look."""

    _rng: ClassVar[Any] = np.random.default_rng(0)

    def profile(self, x: Any, y: Any) -> Any:
        return super().profile(x, y) * self._rng.uniform(1, 1.001)


class Hovering(Indenter):
    """Lowest point a micrometre too high."""

    def profile(self, x: Any, y: Any) -> Any:
        return super().profile(x, y) - 1e-6


class Relative(Indenter):
    """Measures from the highest of the points that it is asked for."""

    def profile(self, x: Any, y: Any) -> Any:
        values = super().profile(x, y)
        return values - values.max()


class Aloof(Indenter):
    """Ends with the domain, its lowest point a twentieth of its range too high."""

    footprint: ClassVar[Any] = "domain"

    def profile(self, x: Any, y: Any) -> Any:
        values = super().profile(x, y)
        return values - 0.05 * np.ptp(values)


class Misspelt(Indenter):
    """Ends where nobody looks."""

    footprint: ClassVar[Any] = "Domain"


class ComplexHeights(Indenter):
    """Heights with an imaginary part."""

    def profile(self, x: Any, y: Any) -> Any:
        return super().profile(x, y) + 0j


class NotANumber(Indenter):
    """Heights that are not known everywhere."""

    def profile(self, x: Any, y: Any) -> Any:
        return np.where(x > 5e-4, np.nan, super().profile(x, y))


class Insensitive(Indenter):
    """Force curve that does not know what the tension does."""

    def force_curve(self, depth: Any, length: Any) -> Any:
        values = super().force_curve(depth, length)
        return values._replace(by_length=0 * values.by_length)


class Shallow(Indenter):
    """Force curve that changes the depths that it is given."""

    def force_curve(self, depth: Any, length: Any) -> Any:
        depth[...] = np.maximum(depth, 0)
        return super().force_curve(depth, length)


INDENTERS = {
    Insensitive: "force_curve_rises",
    Shallow: "force_curve_rises",
    Misspelt: "footprint_is_known",
    ComplexHeights: "profile_has_the_shape_of_the_grid",
    NotANumber: "profile_is_nowhere_positive",
    Flattened: "profile_has_the_shape_of_the_grid",
    Raised: "profile_is_nowhere_positive",
    Gone: "profile_is_nowhere_positive",
    Moving: "profile_is_pure",
    Random: "profile_is_pure",
    Hovering: "lowest_point_is_at_zero",
    Relative: "heights_depend_on_their_own_point",
    Aloof: "run_converges",
}


@pytest.mark.parametrize(
    ("mutant", "rule"), INDENTERS.items(), ids=lambda value: getattr(value, "__name__", "")
)
def test_mutant_is_caught(mutant: Any, rule: str) -> None:
    """The message names the class, the rule, what is asked and what was found."""
    check_mutant("indenter", mutant(radius=1e-3), rule)


def test_what_the_mutants_are_made_of_is_whole() -> None:
    """Without its fault each mutant breaks nothing but that no plugin registers it."""
    check_base("indenter", Indenter(radius=1e-3))


def test_each_rule_has_a_mutant(monkeypatch: pytest.MonkeyPatch) -> None:
    """No rule could be dropped, or say yes to everything, without a test that fails."""
    assert rules_of("indenter", monkeypatch) == set(INDENTERS.values())
