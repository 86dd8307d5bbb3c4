"""Units in texts, and their factors to SI, with pint."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

from pellicle.errors import shown

if TYPE_CHECKING:
    import pint

NUMBER_AND_UNIT = re.compile(
    r"([-+]?(?:nan\b|inf\b|(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?))\s*(.*)", re.DOTALL | re.IGNORECASE
)
# pint evaluates every number and power in a text, and "Pa*9**9**9**9" never ends. So only products
# and quotients of names, each with one small power, are passed to it.
_LETTER = r"[^\W\d⁰¹²³⁴-⁹]"
_NAME = rf"(?:{_LETTER}|[°%‰])(?:{_LETTER}|[0-9])*"
_EXPONENT = r"[-+]?\d{1,2}(?:\.\d{1,20})?"
_POWER = (
    rf"(?: ?(?:\*\*|\^) ?(?:{_EXPONENT}|\({_EXPONENT}(?:/\d{{1,2}})?\))"
    r"|⁻?[⁰¹²³⁴-⁹]{1,2})?"
)
_FACTOR = rf"(?:\( ?)*(?:1(?![\w.])|{_NAME}){_POWER}(?: ?\){_POWER})*"
_UNIT = re.compile(rf"{_FACTOR}(?:(?: ?[*/·⋅×.] ?| ){_FACTOR})*")
_LONGEST_UNIT = 100
NOUNS = {
    "m": "a length",
    "Pa": "a pressure",
    "N/m": "a tension",
    "J/m**2": "an energy per area",
    "N*m": "a bending stiffness",
    "Pa/m": "a stiffness per area",
    "N": "a force",
    "J": "an energy",
    "m**2": "an area",
    "m**3": "a volume",
    "rad": "an angle",
    "s": "a time",
    "m/V": "a length per voltage",
    "m/s": "a speed",
    "Hz": "a frequency",
    "m/Pa": "a compliance",
    "rad/m": "a wavenumber",
}
"""Nouns for the values that a field takes, by its SI unit."""
_MEASURED = {
    "m": "a length",
    "N": "a force",
    "Pa": "a pressure",
    "N/m": "a force per length",
    "J": "an energy",
    "Pa/m": "a pressure per length",
    "m**2": "an area",
    "m**3": "a volume",
    "s": "a time",
    "1/m": "an inverse length",
    "m/s": "a speed",
    "Hz": "a frequency",
    "kg": "a mass",
    "kg/m**3": "a density",
    "Pa*s": "a viscosity",
    "K": "a temperature",
    "V": "a voltage",
    "A": "a current",
    "W": "a power",
    "m/V": "a length per voltage",
}
"""Nouns for values of other dimensions, by a unit of that dimension."""


def _root(quantity: Any) -> str:
    """Return the unit to which pint reduces a quantity, such as radian."""
    return str(quantity.to_root_units().units)


@cache
def pint_registry() -> pint.UnitRegistry[Any]:
    """Return the registry that all of the application shares."""
    # pint takes a fifth of a second to import, so it is imported only for a text with a unit.
    import pint

    registry: pint.UnitRegistry[Any] = pint.application_registry.get()  # type: ignore[no-untyped-call]
    return registry


def split(text: str) -> tuple[float, str] | None:
    """Return number and unit of a text like ``"10 kPa"``; None for any other text."""
    match = NUMBER_AND_UNIT.fullmatch(text.strip())
    return (float(match[1]), match[2]) if match else None


def _is_unit(text: str) -> bool:
    """Return whether a text is a product of names with powers, which pint parses quickly."""
    return len(text) <= _LONGEST_UNIT and _UNIT.fullmatch(text) is not None


def one(unit: str) -> Any:
    """Return 1 of a unit as a pint quantity in SI, whose arithmetic keeps dimensions.

    Raises
    ------
    ValueError
        The unit is unknown.
    """
    if _is_unit(unit):
        try:
            return pint_registry().Quantity(1.0, unit).to_base_units()
        except Exception:
            # pint raises a dozen unrelated types (syntax, token, attribute errors) for bad units.
            pass
    raise ValueError(f"has an unknown unit ({shown(unit)})")


def si_unit(value: Any) -> str:
    """Return the SI unit of a pint quantity as datasets write it; ``"1"`` for a pure number.

    A unit without a name of its own is a product of N, m and s.
    """
    dimensions: Mapping[str, float] = getattr(value, "dimensionality", {})
    if not dimensions or not all(map(math.isfinite, dimensions.values())):
        return "1"
    named_unit = next((u for u in [*_MEASURED, *NOUNS] if one(u).dimensionality == dimensions), "")
    if not named_unit and not dimensions.keys() <= {"[mass]", "[length]", "[time]"}:
        return "1"
    mass, length, time = (dimensions.get(f"[{name}]", 0) for name in ("mass", "length", "time"))
    powers = {"N": mass, "m": length - mass, "s": time + 2 * mass}
    parts = (f"{n}**{power:g}" if power != 1 else n for n, power in powers.items() if power)
    return (named_unit or "*".join(parts)).replace("m**2", "m2")


# pint takes half a millisecond for a conversion, and a study has thousands of values.
@lru_cache(maxsize=1000)
def factor_to_si(unit: str, si: str) -> float:
    """Return the factor from ``unit`` to the unit ``si``.

    Raises
    ------
    ValueError
        The unit is unknown or does not fit.
    """
    unknown = f"has an unknown unit ({shown(unit)})"
    if not _is_unit(unit):
        raise ValueError(unknown)
    registry = pint_registry()
    try:
        single, root = registry.Quantity(1.0, unit), _root(registry.Quantity(1.0, si))
        factor = float(single.to(si).magnitude)
        zero = float(registry.Quantity(0.0, unit).to(si).magnitude)
    except Exception as error:
        # pint raises a dozen unrelated types (syntax, token, attribute errors) for bad units.
        if type(error).__name__ != "DimensionalityError":
            raise ValueError(unknown) from None
        raise ValueError(f"is {_measured(unit)}") from None
    # In pint per cent, decibels and counts have no dimension, and neither have angles.
    if _root(single) != root:
        raise ValueError(f"is {_measured(unit)}")
    if zero != 0:
        raise ValueError(f"is in a unit whose zero is {zero:.6g} {si}")
    if not 0 < factor < math.inf:
        raise ValueError(f"is in a unit of {factor:g} {si}")
    return factor


def _measured(unit: str) -> str:
    """Return what a unit that pint knows measures, as a noun with its article."""
    registry = pint_registry()
    dimension = registry.Unit(unit).dimensionality
    if not dimension:
        root = _root(registry.Quantity(1.0, unit))
        kinds = {"dimensionless": "a pure number", "radian": "an angle"}
        return kinds.get(root, f"a number of {root}")
    for base_unit, noun in _MEASURED.items():
        if registry.Unit(base_unit).dimensionality == dimension:
            return noun
    return f"a value in {unit}"
