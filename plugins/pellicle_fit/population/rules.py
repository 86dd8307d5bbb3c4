"""Rules by which the fits of a population are accepted, such as ``reduced_modulus < 1 MPa``."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable

import numpy as np

from pellicle import registry
from pellicle.errors import ConfigError, shown
from pellicle.schema import evaluate, names_in, nearest
from pellicle.units import one, readable, split
from pellicle_fit.effect import Effect, Fittable, Solid, quantities

from .row import ENDS, NUMBERS, Row

_SIGNS: dict[str, Callable[[float, float], bool]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    ">": operator.gt,
}
_COMPARISON = re.compile(f"({'|'.join(_SIGNS)})")
_EXAMPLE = "write one such as 'r_squared > 0.95' or '1 kPa < reduced_modulus < 1 MPa'"


def units() -> dict[str, str]:
    """Return the unit of each of the values of a row, which rules may contain, by name."""
    effects = registry().components.get(Effect.family, {}).values()
    names = {"youngs_modulus": "Pa"}
    for component in (Solid, *(effect.component for effect in effects)):
        if isinstance(component, type) and issubclass(component, Fittable):
            names |= {name: quantity.unit for name, quantity in quantities(component).items()}
    return {f"{name}{end}": unit for name, unit in names.items() for end in ENDS} | NUMBERS


class Rule:
    """One or two comparisons of expressions and quantities; names and dimensions are checked."""

    def __init__(self, text: str) -> None:
        rule, unit_of = shown(text), units()
        parts = [part.strip() for part in _COMPARISON.split(text)]
        self.text, self._signs, sides = text, parts[1::2], parts[::2]
        self._sides: list[float | str] = []
        self._units: dict[str, str] = {}
        dimensions = {}
        for side in sides if len(sides) in (2, 3) and all(sides) else ():
            number, unit = split(side) or (0.0, "")
            is_quantity = unit[:1].isalpha()
            names = set[str]() if is_quantity else names_in(side)
            for name in sorted(names - unit_of.keys()):
                raise ConfigError(f"{shown(name)} in {rule}: {nearest(name, unit_of)}")
            ones = {name: 1.0 if unit_of[name] == "1" else one(unit_of[name]) for name in names}
            value = number * one(unit) if is_quantity else evaluate(side, ones)
            # A bare number is in SI.
            if is_quantity or names:
                dimensions[str(getattr(value, "dimensionality", "dimensionless"))] = side
            self._sides.append(float(value.magnitude) if is_quantity else side)
            self._units |= {name: unit_of[name] for name in names}
        if not self._units:
            raise ConfigError(f"{rule} does not compare a number of the fit; {_EXAMPLE}")
        if len(dimensions) > 1:
            texts = " with ".join(f"{side} ({name})" for name, side in dimensions.items())
            raise ConfigError(f"{rule} compares {texts}; {_EXAMPLE}")

    def objection(self, row: Row) -> str:
        """Return why a fit breaks the rule; empty if it does not."""
        known = row.values()
        numbers = {name: known.get(name, np.nan) for name in sorted(self._units)}
        sides = [float(evaluate(s, numbers) if isinstance(s, str) else s) for s in self._sides]
        pairs = zip(sides[:-1], self._signs, sides[1:], strict=True)
        if not any(map(np.isnan, sides)) and all(_SIGNS[sign](a, b) for a, sign, b in pairs):
            return ""
        texts = (
            f"{name} is {'unknown' if np.isnan(v) else readable(v, self._units[name], 4)}"
            for name, v in numbers.items()
        )
        return f"{', '.join(texts)}, against {self.text}"


def rules(texts: tuple[str, ...]) -> tuple[str, ...]:
    """Return the texts of rules; it raises what `Rule` does."""
    for text in texts:
        Rule(text)
    return texts
