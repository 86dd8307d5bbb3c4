"""Units in texts, and their factors to SI, with pint."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from pellicle.errors import excerpt

NUMBER_AND_UNIT = re.compile(
    r"([-+]?(?:nan\b|inf(?:inity)?\b|(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?))\s*(.*)",
    re.DOTALL | re.IGNORECASE,
)
# pint computes with the numbers in a text, and never ends "Pa*9**9**9**9". So only products and
# quotients of names reach it, each name with one small power, and no power of a parenthesis.
_LETTER = r"[^\W\d⁰¹²³⁴-⁹]|[°%‰]"
_POWER = r" ?(?:\*\*|\^) ?(?:[-+]?\d\d?(?:\.\d+)?|\([-+]?\d\d?(?:[./]\d+)?\))|⁻?[⁰¹²³⁴-⁹]{1,2}"
_NAME = rf"(?:{_LETTER})(?:{_LETTER}|\d)*(?:{_POWER})?"
_UNIT = re.compile(rf"(?:1 ?/)?[( ]*{_NAME}(?:[) ]*[ */·⋅×.][( ]*{_NAME})*[) ]*")
_LONGEST_UNIT = 100
# m2 is the spelling of datasets and of UDUNITS; no unit of pint ends in such a digit.
_POWER_BEHIND = re.compile(r"(?<=[^\W\d_])([2-9])(?![\w.])")
_NAMED = (
    *("rad", "m", "N", "Pa", "N/m", "J", "Pa/m", "m2", "m3", "s", "1/m", "m/s", "Hz", "kg"),
    *("kg/m3", "Pa*s", "K", "V", "A", "W", "m/V", "m/Pa"),
)
"""The units in which datasets have values, one for each dimension."""


def split(text: str) -> tuple[float, str] | None:
    """Return number and unit of a text like ``"10 kPa"``; None for any other text."""
    match = NUMBER_AND_UNIT.fullmatch(text.strip())
    return (float(match[1]), match[2]) if match else None


def unit_quantity(unit: str) -> Any:
    """Return 1 of a unit as a pint quantity in SI, whose arithmetic keeps dimensions."""
    return _quantity(1.0, unit).to_base_units()


def _quantity(number: float, unit: str) -> Any:
    """Return a number of a unit as a pint quantity of the registry that the process shares."""
    # pint takes a fifth of a second to import, so it is imported only for a text with a unit.
    import pint

    # Runs of blanks can be divided among the parts of the pattern in more ways than can be tried.
    spelled = _POWER_BEHIND.sub(r"**\1", " ".join(unit.split()))
    if len(spelled) <= _LONGEST_UNIT and _UNIT.fullmatch(spelled):
        try:
            quantity = pint.application_registry.get().Quantity(number, spelled)  # type: ignore[no-untyped-call]
            quantity.to_base_units()
            return quantity
        except Exception:
            # pint raises a dozen unrelated types (syntax, token, attribute errors) for bad units;
            # decibels and large powers fail in SI only.
            pass
    raise ValueError(f"has an unknown unit ({excerpt(unit)})")


def si_unit(value: Any) -> str:
    """Return the SI unit of a pint quantity as datasets write it.

    A unit without a name of its own is a product of N, m and s, and ``"1"`` if it is none, as that
    of a pure number.
    """
    dimensions: Mapping[str, float] = getattr(value, "dimensionality", {})
    if not dimensions or not all(map(math.isfinite, dimensions.values())):
        return "1"
    named_unit = next((u for u in _NAMED if unit_quantity(u).dimensionality == dimensions), "")
    if not named_unit and not dimensions.keys() <= {"[mass]", "[length]", "[time]"}:
        return "1"
    mass, length, time = (dimensions.get(f"[{name}]", 0) for name in ("mass", "length", "time"))
    powers = {"N": mass, "m": length - mass, "s": time + 2 * mass}
    parts = (
        name if power == 1 else f"{name}{'' if power in range(2, 10) else '**'}{power:g}"
        for name, power in powers.items()
        if power
    )
    return named_unit or "*".join(parts)


# pint takes half a millisecond for a conversion, and a study has thousands of values.
@lru_cache(maxsize=1000)
def factor_to_si(unit: str, si: str) -> float:
    """Return the factor from ``unit`` to the unit ``si``; refuse a unit that does not fit."""
    # Per cent and angles have no dimension, but root units of their own.
    if unit_quantity(unit).to_root_units().units != unit_quantity(si).to_root_units().units:
        raise ValueError(f"is in {unit}, which is no unit of {si}")
    to = _quantity(1.0, si).units
    factor, zero = (float(_quantity(x, unit).to(to).magnitude) for x in (1.0, 0.0))
    if zero != 0:
        raise ValueError(f"is in a unit whose zero is {zero:.6g} {si}")
    if not 0 < factor < math.inf:
        raise ValueError(f"is in a unit of {factor:g} {si}")
    return factor
