"""Field types that accept ``0.01``, ``"10 kPa"`` or a pint quantity and store SI floats.

Inside pellicle every number is in SI; units exist only in texts that are read and shown.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property
from numbers import Real
from typing import Annotated, Any, ClassVar, Final, get_args

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.fields import FieldInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import core_schema

from pellicle.errors import excerpt

from .conversion import NUMBER_AND_UNIT, factor_to_si
from .conversion import si_unit as si_unit
from .conversion import split as split
from .conversion import unit_quantity as unit_quantity
from .scales import DIGITS as DIGITS
from .scales import NOTHING as NOTHING
from .scales import Scale as Scale
from .scales import axis_unit as axis_unit
from .scales import decimal as decimal
from .scales import format_unit as format_unit
from .scales import readable as readable

_EXAMPLES = {
    "m": "10 um",
    "Pa": "10 kPa",
    "N/m": "50 mN/m",
    "J/m2": "50 mJ/m2",
    "N*m": "1 pN*m",
    "Pa/m": "1 kPa/mm",
    "N": "5 nN",
    "N/s": "1 nN/s",
    "m/N": "1 um/nN",
    "Pa*s": "1 Pa*s",
    "m2": "0.01 mm2",
    "m2/s": "200 um2/s",
    "m3": "0.001 mm3",
    "rad": "70 degree",
    "s": "1 s",
    "Hz": "1 Hz",
}
_LIMITS = (
    (">", "exclusiveMinimum", operator.gt),
    ("≥", "minimum", operator.ge),
    ("<", "exclusiveMaximum", operator.lt),
    ("≤", "maximum", operator.le),
)
"""Sign, keyword in JSON schemas and meaning of the bounds of a `Quantity`, in their order."""

LARGEST: Final = 1e100
"""Bound of numbers in SI; its inverse bounds those near 0. Their squares can be represented."""


@dataclass(frozen=True)
class Quantity:
    """Annotation of a float field: its SI unit and its bounds.

    Parameters
    ----------
    unit
        SI unit, e.g. ``"Pa"``; ``"1"`` for a pure number.
    above, at_least, below, at_most
        Bounds in that unit; ``above`` and ``below`` exclude the bound.
    hint
        What else would help if a value is out of bounds, at the end of the message.
    """

    unit: str
    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None
    hint: str = ""
    left_out: ClassVar[str] = "none"
    """Words for a value that is not given."""

    def __call__(self, value: object) -> float:
        """Return ``value`` in SI.

        One that is no number, lacks a unit, has another dimension, is not finite, is beyond
        `LARGEST` or out of bounds is a ValueError.
        """
        number = value if type(value) is float else self._in_si(value)
        if not math.isfinite(number):
            raise ValueError(f"{excerpt(value)} is not finite; give {self._wanted()}")
        for _, _, holds, bound in self._limits:
            if not holds(number, bound):
                raise ValueError(
                    f"{excerpt(value)} is not allowed; give {self._wanted()}{self.hint}"
                )
        if number and not 1 / LARGEST < abs(number) < LARGEST:
            raise ValueError(
                f"{excerpt(value)} is too large or too near 0 to compute with; check the unit"
            )
        # Of −0, tables would show the sign, and a run would not be the one of 0.
        return number + 0.0

    def _in_si(self, value: object) -> float:
        """Return a number, or a text with a unit, in SI; possibly not finite."""
        if isinstance(value, Real) and not isinstance(value, bool):
            try:
                return float(value)
            except OverflowError:
                return math.inf
        if isinstance(getattr(value, "magnitude", None), Real) and hasattr(value, "units"):
            value = f"{float(value.magnitude)!r} {value.units}".removesuffix("dimensionless")  # type: ignore[attr-defined]
        if not isinstance(value, str):
            raise ValueError(f"{excerpt(value)} is not a number; give {self._wanted()}")
        match = NUMBER_AND_UNIT.fullmatch(value.strip())
        if match is None:
            raise ValueError(f"{excerpt(value)} is not a number with a unit; give {self._wanted()}")
        number, unit = float(match[1]), match[2]
        if not math.isfinite(number):
            return number
        if self.unit == "1":
            if unit:
                raise ValueError(f"{excerpt(value)} has a unit; give {self._wanted()}")
            return number
        if not unit:
            raise ValueError(f"{excerpt(value)} is text without a unit; give {self._wanted()}")
        try:
            factor = factor_to_si(unit, self.unit)
        except ValueError as problem:
            raise ValueError(f"{excerpt(value)} {problem}; give {self._wanted()}") from None
        # In decimal "10 um" is 1e-05; in binary it would be 9.999999999999999e-06. The exponent of
        # what is 0 in binary may be beyond decimals.
        return float(Decimal(match[1]) * Decimal(repr(factor))) if number else 0.0

    @property
    def has_known_unit(self) -> bool:
        """Whether values in other units can be converted to its unit."""
        try:
            return self.unit in ("1", *_EXAMPLES) or factor_to_si(self.unit, self.unit) > 0
        except ValueError:
            return False

    def powers(self) -> tuple[int, int, int]:
        """Return the powers of N, m and s in the unit."""
        dimensions = {} if self.unit == "1" else unit_quantity(self.unit).dimensionality
        mass, length, time = (int(dimensions.get(f"[{d}]", 0)) for d in ("mass", "length", "time"))
        return mass, length - mass, time + 2 * mass

    @cached_property
    def _limits(self) -> list[tuple[str, str, Callable[[float, float], bool], float]]:
        bounds = self.above, self.at_least, self.below, self.at_most
        return [(*limit, b) for limit, b in zip(_LIMITS, bounds, strict=True) if b is not None]

    @property
    def bounds(self) -> list[str]:
        """The bounds as text, e.g. ``["> 0", "≤ 0.5"]``."""
        return [f"{sign} {bound:g}" for sign, _, _, bound in self._limits]

    @property
    def example(self) -> str | float:
        """A usual value, as text with its unit or as a number."""
        return 1.0 if self.unit == "1" else _EXAMPLES.get(self.unit, f"1 {self.unit}")

    def _wanted(self) -> str:
        """Return what is allowed, for messages: "a value > 0 m with its unit, such as '10 um'"."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        allowed = " and".join(f" {bound}{unit}" for bound in self.bounds)
        if self.unit == "1":
            return f"a plain number{allowed}"
        example = f", such as {_EXAMPLES[self.unit]!r}" if self.unit in _EXAMPLES else ""
        return f"a value{allowed} with its unit{example}, or a bare number in {self.unit}"

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        number = {"type": "number"} | {key: bound for _, key, _, bound in self._limits}
        if self.unit == "1":
            return number
        text: dict[str, Any] = {"type": "string", "pattern": r"^\s*[-+]?[0-9.].*[A-Za-zµ°]"}
        if self.unit in _EXAMPLES:
            text["examples"] = [_EXAMPLES[self.unit]]
        return {"anyOf": [number, text], "unit": self.unit}


def quantity_of(info: FieldInfo) -> Quantity | None:
    """Return the quantity of a field of one or several values; None for any other field."""
    for part in (*info.metadata, *parts_of(info.annotation)):
        quantity = getattr(part, "quantity", part)
        if isinstance(quantity, Quantity):
            return quantity
    return None


def parts_of(annotation: Any) -> list[Any]:
    """Return a type, the types that it is made of, and what they are annotated with."""
    parts = [annotation]
    # The list grows while it is gone through.
    for part in parts:
        parts += get_args(part)
    return parts


Length = Annotated[float, Quantity("m", above=0)]
"""A length > 0 [m]."""
Modulus = Annotated[float, Quantity("Pa", above=0)]
"""An elastic modulus > 0 [Pa]."""
Tension = Annotated[float, Quantity("N/m", at_least=0)]
"""A surface tension ≥ 0 [N/m]."""
BendingStiffness = Annotated[float, Quantity("N*m", at_least=0)]
"""The bending stiffness of a plate ≥ 0 [N*m]."""
WorkOfAdhesion = Annotated[float, Quantity("J/m2", above=0)]
"""An energy per area > 0 [J/m²]."""
Strength = Annotated[float, Quantity("Pa", above=0)]
"""A traction > 0 [Pa]."""
FoundationStiffness = Annotated[float, Quantity("Pa/m", above=0)]
"""A stiffness per area > 0 [Pa/m]."""
Time = Annotated[float, Quantity("s", above=0)]
"""A time > 0 [s]."""
PoissonsRatio = Annotated[float, Quantity("1", above=-1, at_most=0.5)]
"""Poisson's ratio, above −1 and at most ½."""
