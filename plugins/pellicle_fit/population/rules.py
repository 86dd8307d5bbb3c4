"""Rules by which the fits of a population are accepted, such as ``reduced_modulus < 1 MPa``."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pellicle import registry
from pellicle.errors import ConfigError, shown
from pellicle.schema import evaluate, names_in, nearest
from pellicle.units import one, readable, split
from pellicle_fit.effect import Effect, Fittable, quantities
from pellicle_fit.explanation import Solid

from .row import ENDS, NUMBERS, Row

_COMPARISONS: dict[str, Callable[[float, float], bool]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    ">": operator.gt,
}
_COMPARISON = re.compile("|".join(_COMPARISONS))
_EXAMPLE = "write one such as 'r_squared > 0.95' or '1 kPa < reduced_modulus < 1 MPa'"


def units() -> dict[str, str]:
    """Return the names that rules may contain, each with its unit."""
    effects = registry().components.get(Effect.family, {}).values()
    components = [Solid, *(effect.component for effect in effects)]
    names = {"youngs_modulus": "Pa"}
    for component in components:
        if isinstance(component, type) and issubclass(component, Fittable):
            names |= {name: quantity.unit for name, quantity in quantities(component).items()}
    ends = {f"{name}{end}": unit for name, unit in names.items() for end in ENDS}
    return ends | NUMBERS


@dataclass(frozen=True)
class Rule:
    """One or two comparisons of expressions and quantities."""

    text: str

    @cached_property
    def _sides(self) -> list[str]:
        return [side.strip() for side in _COMPARISON.split(self.text)]

    @cached_property
    def _signs(self) -> list[str]:
        return _COMPARISON.findall(self.text)

    @cached_property
    def names(self) -> list[str]:
        """The names in the rule."""
        return sorted(set().union(*(names_in(s) for s in self._sides if not _quantity(s))))

    def check(self) -> None:
        """Check that the rule compares values of one dimension.

        Raises
        ------
        ConfigError
            It does not, or names something unknown.
        """
        rule, unit_of = shown(self.text), units()
        if len(self._sides) not in (2, 3) or not all(self._sides) or not self.names:
            raise ConfigError(f"{rule} does not compare a number of the fit; {_EXAMPLE}")
        for name in self.names:
            if name not in unit_of:
                raise ConfigError(f"{shown(name)} in {rule}: {nearest(name, unit_of)}")
        ones = {name: one(unit_of[name]) if unit_of[name] != "1" else 1.0 for name in self.names}
        dimensions = {}
        for side in self._sides:
            number = _quantity(side)
            try:
                value = one(number[1]) if number else evaluate(side, ones)
            except ConfigError:
                raise
            except ValueError as error:
                raise ConfigError(f"{shown(side)} in {rule} {error}") from None
            # A bare number is in SI.
            if number or names_in(side):
                dimensions[str(getattr(value, "dimensionality", "dimensionless"))] = side
        if len(dimensions) > 1:
            sides = " with ".join(f"{side} ({name})" for name, side in dimensions.items())
            raise ConfigError(f"{rule} compares {sides}; {_EXAMPLE}")

    def objection(self, row: Row) -> str:
        """Return why a fit breaks the rule; empty if it does not."""
        unit_of, known = units(), row.values()
        numbers = {name: known.get(name, np.nan) for name in self.names}
        sides = [_value(side, numbers) for side in self._sides]
        pairs = zip(sides[:-1], self._signs, sides[1:], strict=True)
        if not any(map(np.isnan, sides)) and all(_COMPARISONS[s](a, b) for a, s, b in pairs):
            return ""
        texts = (
            f"{name} is {'unknown' if np.isnan(v) else readable(v, unit_of[name], 4)}"
            for name, v in numbers.items()
        )
        return f"{', '.join(texts)}, against {self.text}"


def _quantity(side: str) -> tuple[float, str] | None:
    """Return number and unit of a side such as ``1 MPa``; None for an expression."""
    number = split(side)
    return number if number is not None and number[1][:1].isalpha() else None


def _value(side: str, numbers: Mapping[str, float]) -> float:
    """Return the value of a side in SI."""
    number = _quantity(side)
    return number[0] * float(one(number[1]).magnitude) if number else float(evaluate(side, numbers))


def rules(texts: tuple[str, ...]) -> tuple[str, ...]:
    """Return rules that are valid.

    Raises
    ------
    ConfigError
        A rule is not a comparison, or names something unknown, or compares different dimensions.
    """
    for text in texts:
        Rule(text).check()
    return texts
