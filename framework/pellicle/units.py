"""Field types that accept ``0.01``, ``"10 kPa"`` or a pint quantity and store SI floats.

Inside pellicle every number is in SI; units exist only here and where numbers are shown.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from functools import cache, lru_cache
from numbers import Integral, Real
from typing import TYPE_CHECKING, Annotated, Any, Final, NamedTuple, get_args

from pydantic_core import core_schema

from .errors import shown

if TYPE_CHECKING:
    import pint
    from numpy.typing import ArrayLike
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic.fields import FieldInfo
    from pydantic.json_schema import JsonSchemaValue

_EXAMPLES = {
    "m": "10 um",
    "Pa": "10 kPa",
    "N/m": "50 mN/m",
    "J/m**2": "50 mJ/m^2",
    "N*m": "1 pN*m",
    "Pa/m": "1 kPa/mm",
    "N": "2 uN",
    "m**2": "0.01 mm**2",
    "m**3": "0.001 mm**3",
    "rad": "70 degree",
    "s": "1 s",
    "Hz": "1 Hz",
}
_NUMBER_AND_UNIT = re.compile(
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
_FIRST = re.compile(r"([^\W\d_]+)(?:(?:\*\*|\^)?([23]))?(?![\w.^]|\*\*)(.*)")
"""First symbol of a unit, its power if that is 2 or 3, and the rest."""
_PREFIXED = frozenset({"m", "N", "Pa", "J", "s", "V", "A", "W", "Hz"})
"""Units that take prefixes; those of strangers may be counts, photons or decibels."""
_PREFIXES = {
    12: "T",
    9: "G",
    6: "M",
    3: "k",
    0: "",
    -3: "m",
    -6: "µ",
    -9: "n",
    -12: "p",
    -15: "f",
} | {-18: "a", -21: "z", -24: "y"}
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_MOST = 8
"""Largest number of values written out; of more, some are left out."""
DIGITS: Final = 4
"""Significant digits of a number that is shown."""
NOTHING: Final = "–"
"""The text for a number that does not exist."""
_NOUNS = {
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


def _root(one: Any) -> str:
    """Return the unit to which pint reduces a quantity, such as radian."""
    return str(one.to_root_units().units)


@cache
def _registry() -> pint.UnitRegistry[Any]:
    # pint takes a fifth of a second to import, so it is imported only for a text with a unit.
    import pint

    registry: pint.UnitRegistry[Any] = pint.application_registry.get()  # type: ignore[no-untyped-call]
    return registry


def ramp(start: float, stop: float, num: int, *, log: bool = False) -> list[float]:
    """Return ``num`` values from ``start`` to ``stop``, spaced evenly or geometrically."""
    shares = [i / (num - 1) for i in range(num)]
    values = (
        [start * (stop / start) ** share for share in shares]
        if log
        else [(start * (num - 1 - i) + stop * i) / (num - 1) for i in range(num)]
    )
    # Rounding to fifteen digits gives 3e-05 instead of 3.0000000000000004e-05.
    return [float(f"{value:.15g}") for value in values]


def split(text: str) -> tuple[float, str] | None:
    """Return number and unit of a text like ``"10 kPa"``; None for any other text."""
    match = _NUMBER_AND_UNIT.fullmatch(text.strip())
    return (float(match[1]), match[2]) if match else None


def _is_unit(text: str) -> bool:
    """Whether a text is a product of names with powers, which pint parses quickly."""
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
            return _registry().Quantity(1.0, unit).to_base_units()
        except Exception:
            # pint raises a dozen unrelated types (syntax, token, attribute errors) for bad units.
            pass
    raise ValueError(f"has an unknown unit ({shown(unit)})")


# pint takes half a millisecond for a conversion, and a study has thousands of values.
@lru_cache(maxsize=1000)
def _factor(unit: str, si: str) -> float:
    """Return the factor from ``unit`` to the unit ``si``.

    Raises
    ------
    ValueError
        The unit is unknown or does not fit.
    """
    unknown = f"has an unknown unit ({shown(unit)})"
    if not _is_unit(unit):
        raise ValueError(unknown)
    registry = _registry()
    try:
        one, root = registry.Quantity(1.0, unit), _root(registry.Quantity(1.0, si))
        factor = float(one.to(si).magnitude)
        zero = float(registry.Quantity(0.0, unit).to(si).magnitude)
    except Exception as error:
        # pint raises a dozen unrelated types (syntax, token, attribute errors) for bad units.
        if type(error).__name__ != "DimensionalityError":
            raise ValueError(unknown) from None
        raise ValueError(f"is {_measured(unit)}") from None
    # In pint per cent, decibels and counts have no dimension, and neither have angles.
    if _root(one) != root:
        raise ValueError(f"is {_measured(unit)}")
    if zero != 0:
        raise ValueError(f"is in a unit whose zero is {zero:.6g} {si}")
    if not 0 < factor < math.inf:
        raise ValueError(f"is in a unit of {factor:g} {si}")
    return factor


def _measured(unit: str) -> str:
    """Return what a unit that pint knows measures, as a noun with its article."""
    registry = _registry()
    dimension = registry.Unit(unit).dimensionality
    if not dimension:
        root = _root(registry.Quantity(1.0, unit))
        kinds = {"dimensionless": "a pure number", "radian": "an angle"}
        return kinds.get(root, f"a number of {root}")
    for base_unit, noun in _MEASURED.items():
        if registry.Unit(base_unit).dimensionality == dimension:
            return noun
    return f"a value in {unit}"


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
            return value if isinstance(value, str) else shown(value)
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


def example(unit: str) -> str:
    """Return a value in a unit as text, such as ``"10 kPa"``."""
    return _EXAMPLES.get(unit, f"1 {unit}")


def printed(unit: str) -> str:
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
        return Scale(1.0, printed(unit))
    power = int(match[2] or 1)
    lowest = 1.0 if power == 1 else 0.1
    exponent = 3 * math.floor(round(math.log10(highest) / power - math.log10(lowest), 9) / 3)
    if power > 1 or match[1] == "s":
        # 3600 s reads better than 3.6 ks.
        exponent = min(exponent, 0)
    if exponent not in _PREFIXES:
        return Scale(1.0, printed(unit))
    return Scale(10.0 ** (-power * exponent), f"{_PREFIXES[exponent]}{printed(unit)}")


def readable(value: Any, unit: str = "1", digits: int = 6) -> str:
    """Return one or several values, in SI, as text with a unit that brings them near 1 … 1000."""
    values = list(value) if isinstance(value, (list, tuple)) else [value]
    numeric = all(isinstance(v, (int, float)) and v is not True for v in values)
    scale = axis_unit(values, unit) if values and numeric else Scale(1.0, "")
    return scale.listing([scale.number(v, digits) for v in values])


@dataclass(frozen=True)
class Quantity:
    """Annotation of a float field: its SI unit and its bounds.

    Parameters
    ----------
    unit
        SI unit, e.g. ``"Pa"``; ``"1"`` for a pure number.
    above, at_least, below, at_most
        Bounds in that unit; ``above`` and ``below`` exclude the bound.
    noun
        What the values are, with an article, for messages such as "is a force, not a spring
        constant"; without it, a noun for the unit.
    """

    unit: str
    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None
    noun: str = ""

    def __call__(self, value: object) -> float:
        """Return ``value`` in SI.

        Raises
        ------
        ValueError
            The value is not a number, lacks a unit, has another dimension, is not finite or is out
            of bounds.
        """
        number = self._magnitude(value)
        if not math.isfinite(number):
            raise ValueError(f"{shown(value)} is not finite; give {self._wanted()}")
        if not self._within(number):
            raise ValueError(f"{shown(value)} is not allowed; give {self._wanted()}")
        return number

    def _magnitude(self, value: object) -> float:
        if isinstance(value, Real) and not isinstance(value, bool):
            try:
                return float(value)
            except OverflowError:
                return math.inf
        if isinstance(getattr(value, "magnitude", None), Real) and hasattr(value, "units"):
            value = f"{float(value.magnitude)!r} {value.units}".removesuffix("dimensionless")  # type: ignore[attr-defined]
        if not isinstance(value, str):
            raise ValueError(f"{shown(value)} is not a number; give {self._wanted()}")
        if value.strip().lower().lstrip("+-") in ("nan", "inf", "infinity"):
            return float(value)
        match = _NUMBER_AND_UNIT.fullmatch(value.strip())
        if match is None:
            raise ValueError(f"{shown(value)} is not a number with a unit; give {self._wanted()}")
        number, unit = match.groups()
        if self.unit == "1":
            if unit:
                raise ValueError(f"{shown(value)} has a unit; give {self._wanted()}")
            return float(number)
        if not unit:
            raise ValueError(f"{shown(value)} is text without a unit; give {self._with_unit()}")
        return self._convert(number, unit, value)

    def _convert(self, number: str, unit: str, value: str) -> float:
        try:
            factor = _factor(" ".join(unit.split()), self.unit)
        except ValueError as problem:
            noun = self.noun or _NOUNS.get(self.unit, f"a value in {self.unit}")
            contrast = f", not {noun}" if str(problem).startswith("is a") else ""
            raise ValueError(f"{shown(value)} {problem}{contrast}; give {self._wanted()}") from None
        if not math.isfinite(float(number)) or float(number) == 0:
            # Its exponent may be beyond the range of a decimal.
            return float(number)
        # In decimal "10 um" is 1e-05; in binary it would be 9.999999999999999e-06.
        return float(Decimal(number) * Decimal(repr(factor)))

    @property
    def has_known_unit(self) -> bool:
        """Whether values in other units can be converted to its unit."""
        if self.unit == "1" or self.unit in _EXAMPLES:
            return True
        try:
            self._convert("1", self.unit, self.unit)
        except ValueError:
            return False
        return True

    def powers(self) -> tuple[int, int]:
        """Return the powers of Pa and of m in the unit; its power of seconds is ignored."""
        dimensions: Mapping[str, Any] = _registry().Unit(self.unit).dimensionality
        pressure = int(dimensions.get("[mass]", 0))
        return pressure, int(dimensions.get("[length]", 0)) + pressure

    def _within(self, number: float) -> bool:
        return not (
            (self.above is not None and number <= self.above)
            or (self.at_least is not None and number < self.at_least)
            or (self.below is not None and number >= self.below)
            or (self.at_most is not None and number > self.at_most)
        )

    @property
    def bounds(self) -> list[str]:
        """The bounds as text, e.g. ``["> 0", "≤ 0.5"]``."""
        all_four = ((">", self.above), ("≥", self.at_least), ("<", self.below), ("≤", self.at_most))
        return [f"{sign} {bound:g}" for sign, bound in all_four if bound is not None]

    @property
    def example(self) -> str | float:
        """A value within the bounds, as text with its unit or as a number."""
        if self.unit != "1":
            return example(self.unit)
        low = self.above if self.above is not None else self.at_least
        high = self.below if self.below is not None else self.at_most
        if low is None or high is None:
            return 1.0 if low is None else low + 1.0
        return float(f"{low + 0.8 * (high - low):.3g}")

    def _wanted(self) -> str:
        if self.unit == "1":
            return f"a plain number{self._range()}"
        return f"{self._with_unit()}, or a bare number in {self.unit}"

    def _with_unit(self) -> str:
        example = f", such as {_EXAMPLES[self.unit]!r}" if self.unit in _EXAMPLES else ""
        return f"a value{self._range()} with its unit{example}"

    def _range(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        bounds = [f"{bound}{unit}" for bound in self.bounds]
        return f" {' and '.join(bounds)}" if bounds else ""

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        bounds = {
            "exclusiveMinimum": self.above,
            "minimum": self.at_least,
            "exclusiveMaximum": self.below,
            "maximum": self.at_most,
        }
        number = {"type": "number"} | {k: v for k, v in bounds.items() if v is not None}
        if self.unit == "1":
            return number
        text: dict[str, Any] = {"type": "string", "pattern": r"^\s*[-+]?[0-9.].*[A-Za-zµ°]"}
        if self.unit in _EXAMPLES:
            text["examples"] = [_EXAMPLES[self.unit]]
        return {"anyOf": [number, text], "unit": self.unit}


def quantity_of(info: FieldInfo) -> Quantity | None:
    """Return the quantity of a field of one or several values; None for any other field."""
    for annotation in (*info.metadata, *_annotations(info.annotation)):
        quantity = getattr(annotation, "quantity", annotation)
        if isinstance(quantity, Quantity):
            return quantity
    return None


def _annotations(annotation: Any) -> Iterator[Any]:
    """Yield the annotations of the types inside a type."""
    yield from getattr(annotation, "__metadata__", ())
    for inner in get_args(annotation):
        yield from _annotations(inner)


Length = Annotated[float, Quantity("m", above=0)]
"""A length > 0 [m]."""
Depth = Annotated[float, Quantity("m", at_least=0)]
"""A depth ≥ 0 [m], positive into the solid."""
Modulus = Annotated[float, Quantity("Pa", above=0)]
"""An elastic modulus > 0 [Pa]."""
Pressure = Annotated[float, Quantity("Pa", at_least=0)]
"""A pressure ≥ 0 [Pa]."""
Tension = Annotated[float, Quantity("N/m", at_least=0)]
"""A surface tension ≥ 0 [N/m]."""
BendingStiffness = Annotated[float, Quantity("N*m", at_least=0)]
"""The bending stiffness of a plate ≥ 0 [N*m]."""
WorkOfAdhesion = Annotated[float, Quantity("J/m**2", above=0)]
"""An energy per area > 0 [J/m²]."""
Strength = Annotated[float, Quantity("Pa", above=0)]
"""A traction > 0 [Pa]."""
FoundationStiffness = Annotated[float, Quantity("Pa/m", above=0)]
"""A stiffness per area > 0 [Pa/m]."""
Force = Annotated[float, Quantity("N", at_least=0)]
"""A force ≥ 0 [N]."""
Time = Annotated[float, Quantity("s", above=0)]
"""A time > 0 [s]."""
PoissonsRatio = Annotated[float, Quantity("1", above=-1, at_most=0.5)]
"""Poisson's ratio, above −1 and at most ½."""
