"""Numbers as text, in a unit that brings them near 1."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from pellicle.errors import excerpt

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

_FIRST = re.compile(r"([^\W\d_]+)(?:(?:\*\*|\^)?([23]))?(?![\w.^]|\*\*)(.*)")
"""First symbol of a unit, its power if that is 2 or 3, and the rest."""
_PREFIXED = frozenset({"m", "N", "Pa", "J", "s", "V", "A", "W", "Hz"})
"""Units that take prefixes; those of strangers may be counts, photons or decibels."""
_PREFIXES = dict(zip(range(12, -27, -3), [*"TGMk", "", *"mµnpfazy"], strict=True))
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_MOST = 8
"""Largest number of values written out; of more, some are left out."""
DIGITS: Final = 4
"""Significant digits of a number that is shown."""
NOTHING: Final = "–"
"""The text for a number that does not exist."""


class Scale(NamedTuple):
    """The unit in which all values of one kind are shown, in a column or along an axis."""

    factor: float
    """Factor from SI to the unit."""
    unit: str
    """The unit, with a prefix; empty for pure numbers and texts."""

    def number(self, value: object, digits: int = DIGITS) -> str:
        """Return a value in SI as text in the unit, without it; NaN is a dash.

        Whole numbers and texts are not rounded.
        """
        if not isinstance(value, Real) or isinstance(value, bool):
            return value if isinstance(value, str) else excerpt(value)
        if isinstance(value, Integral) and self.factor == 1.0:
            return str(int(value))
        number = float(value) * self.factor
        if math.isnan(number):
            return NOTHING
        if math.isinf(number):
            return "∞" if number > 0 else "-∞"
        return decimal(number, digits)

    def text(self, value: object, digits: int = DIGITS) -> str:
        """Return a value in SI as text with the unit, such as ``"30 mN/m"``."""
        number = self.number(value, digits)
        is_number = not isinstance(value, str) and number != NOTHING
        return self.with_unit(number) if is_number else number

    def with_unit(self, number: str) -> str:
        """Return a number that is in the unit with the unit: ``"30 mN/m"``, ``"70°"``."""
        return f"{number}{'' if self.unit == '°' else ' '}{self.unit}".rstrip()

    def listing(self, numbers: Sequence[str]) -> str:
        """Return numbers as a list, followed by the unit; of many, some are left out."""
        if len(numbers) > _MOST:
            shortened = f"{', '.join(numbers[: _MOST - 2])}, …, {numbers[-1]}"
            return f"{self.with_unit(shortened)} ({len(numbers)} values)"
        joined = ", ".join(numbers)
        return joined if {*numbers} <= {NOTHING} else self.with_unit(joined)


def decimal(number: float, digits: int) -> str:
    """Return a number as text with significant digits, without an exponent below a million."""
    # Adding 0 removes the sign of a negative zero.
    text = f"{number + 0.0:.{digits}g}"
    return f"{number:.0f}" if "e+0" in text and abs(number) < 1e6 else text


def format_unit(unit: str) -> str:
    """Return a unit as it is printed: ``J/m²`` for ``J/m**2``, ``°C`` as it is."""
    raised = re.sub(
        r"(?:\*\*|\^)(?:\((-?\d+)\)|(-?\d+)(?![\d.]))|(?<=[^\W\d_])(\d+)(?![\w.])",
        lambda match: (match[1] or match[2] or match[3]).translate(_RAISED),
        unit,
    )
    return raised.replace("**", "^").replace("*", "·")


def axis_unit(values: ArrayLike, unit: str) -> Scale:
    """Return the scale, with one prefix, that brings the largest of ``values``, in SI, near 1.

    Lengths, forces and the like come to between 1 and 1000, areas and volumes to above 0.01 and
    0.001, since their prefix is raised with the unit. Angles come to degrees. Where no prefix
    serves, and in units that take none, values stay in SI. Pure numbers and texts have an empty
    unit.
    """
    import numpy as np

    if unit in ("", "1"):
        return Scale(1.0, "")
    if unit == "rad":
        return Scale(180 / math.pi, "°")
    finite = np.abs(np.asarray(values)[np.isfinite(values)])
    # Round-off of 1e-6 to 9.999999999999999e-07 must not turn 1 µm into 1000 nm.
    highest = float(f"{float(finite.max(initial=0.0)):.{DIGITS}g}")
    match = _FIRST.fullmatch(unit)
    if match is None or match[1] not in _PREFIXED or not highest:
        return Scale(1.0, format_unit(unit))
    power = int(match[2] or 1)
    lowest = 1.0 if power == 1 else 0.1
    exponent = 3 * math.floor(round(math.log10(highest) / power - math.log10(lowest), 9) / 3)
    if power > 1 or match[1] == "s":
        # 3600 s reads better than 3.6 ks.
        exponent = min(exponent, 0)
    if exponent not in _PREFIXES:
        return Scale(1.0, format_unit(unit))
    return Scale(10.0 ** (-power * exponent), f"{_PREFIXES[exponent]}{format_unit(unit)}")


def readable(value: Any, unit: str = "1", digits: int = 6) -> str:
    """Return one or several values, in SI, as text with a unit that brings them near 1 … 1000."""
    values = list(value) if isinstance(value, (list, tuple)) else [value]
    numeric = all(isinstance(v, (int, float)) and v is not True for v in values)
    scale = axis_unit(values, unit) if values and numeric else Scale(1.0, "")
    return scale.listing([scale.number(v, digits) for v in values])
