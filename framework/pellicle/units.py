"""Field types that accept ``0.01``, ``"10 kPa"`` or a pint quantity and store SI floats.

Inside pellicle every number is in SI; units exist only here and where numbers are shown.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from functools import cache, lru_cache
from numbers import Real
from typing import TYPE_CHECKING, Annotated, Any, get_args

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
_PREFIXABLE = re.compile(r"[^\W\d_]+(?:/.*|\*(?!\*).*)?")
_PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "µ", -9: "n", -12: "p", -15: "f"}
_MOST = 8
"""Largest number of values written out; of more, some are left out."""


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
        measured = registry.Unit(unit).dimensionality
        raise ValueError(f"measures {measured}, not {_dimension(si)}") from None
    # In pint per cent, decibels and counts have no dimension, and neither have angles.
    if _root(one) != root:
        raise ValueError(f"measures {_root(one)}, not {_dimension(si)}")
    if zero != 0:
        raise ValueError(f"is in a unit whose zero is {zero:.6g} {si}")
    if not 0 < factor < math.inf:
        raise ValueError(f"is in a unit of {factor:g} {si}")
    return factor


def _dimension(unit: str) -> str:
    dimension = str(_registry().Unit(unit).dimensionality)
    return "an angle" if dimension == "dimensionless" else dimension


def axis_unit(values: ArrayLike, unit: str) -> tuple[float, str]:
    """Return a factor and a prefixed unit that bring ``values``, in SI, to between 1 and 1000.

    A unit that begins with a power, such as m⁴, takes no prefix, since the power would apply to the
    prefix too; areas do take one, chosen accordingly. Pure numbers and texts have an empty unit.
    """
    import numpy as np

    if unit in ("", "1"):
        return 1.0, ""
    finite = np.abs(np.asarray(values)[np.isfinite(values)])
    highest = float(finite.max(initial=0.0))
    if unit in ("m2", "m**2"):
        # The prefix of a square counts twice: 1 mm² is 1e-6 m²; down to 0.01 mm² reads well.
        exponent = 3 * int(np.floor(np.log10(10 * np.sqrt(highest)) / 3)) if highest else 0
        exponent = min(max(exponent, -15), 0)
        return 10.0 ** (-2 * exponent), f"{_PREFIXES[exponent]}m²"
    if not _PREFIXABLE.fullmatch(unit):
        return 1.0, unit
    exponent = 3 * int(np.floor(np.log10(highest) / 3)) if highest else 0
    exponent = min(max(exponent, -15), 9)
    return 10.0**-exponent, f"{_PREFIXES[exponent]}{unit}"


def readable(value: Any, unit: str = "1", digits: int = 6) -> str:
    """Return one or several values, in SI, as text with a unit that brings them near 1 … 1000."""
    values = list(value) if isinstance(value, (list, tuple)) else [value]
    numeric = all(isinstance(v, (int, float)) and v is not True for v in values)
    factor, name = axis_unit(values, unit) if values and numeric else (1.0, "")
    if name:
        texts = [f"{v * factor:.{digits}g}" for v in values]
    else:
        texts = [f"{v:.{digits}g}" if isinstance(v, float) else _text(v) for v in values]
    if len(texts) > _MOST:
        return f"{', '.join(texts[: _MOST - 2])}, …, {texts[-1]} {name}".rstrip() + (
            f" ({len(values)} values)"
        )
    return f"{', '.join(texts)} {name}".rstrip()


def _text(value: Any) -> str:
    return value if isinstance(value, str) else shown(value)


@dataclass(frozen=True)
class Quantity:
    """Annotation of a float field: its SI unit and its bounds.

    Parameters
    ----------
    unit
        SI unit, e.g. ``"Pa"``; ``"1"`` for a pure number.
    above, at_least, below, at_most
        Bounds in that unit; ``above`` and ``below`` exclude the bound.
    """

    unit: str
    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None

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
            raise ValueError(f"{shown(value)} {problem}; give {self._wanted()}") from None
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
