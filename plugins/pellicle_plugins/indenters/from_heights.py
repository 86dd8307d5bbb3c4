"""Indenters whose heights are read from a file or an array."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import (
    BeforeValidator,
    Field,
    PrivateAttr,
    SerializerFunctionWrapHandler,
    model_serializer,
)

from pellicle.arrays import Array
from pellicle.components import Component, Footprint, Indenter
from pellicle.errors import ConfigError
from pellicle.units import Length


def length_of(value: object) -> object:
    """Return ``"1 um"`` for ``"um"``; any other value unchanged."""
    return f"1 {value}" if isinstance(value, str) and value.strip().isalpha() else value


HeightUnit = Annotated[Length, BeforeValidator(length_of, json_schema_input_type=float | str)]
"""A length [m] that heights without a unit count: ``"um"``, ``"1 um"``, or a number of metres."""


_MARKS = 999, 9999, 99999, 999.25, 32767, 32768, 65535, 2147483647, 2147483648, 4294967295
"""Numbers that, with either sign, programs write for a missing point and a surface may have."""
_FEWEST, _FAR = 30, 2.0
"""Number of heights between the lowest and the highest that tell how far heights differ, and how
many times farther a number is that marks missing points though it is not usual."""


def marks_in(heights: Array, unit: float, *, is_steep: bool = False) -> list[str]:
    """Return what to do with the lowest and highest heights [m] if they mark missing points.

    ``unit`` is the length [m] of 1 in the file. A mark is farther from all heights between the
    lowest and the highest than these are from each other, twice as far if its number is not usual;
    on a surface that is too steep a usual number, or any that is as far, is enough.
    """
    measured = heights[np.isfinite(heights)]
    ends = np.unique([measured.min(), measured.max()]) if measured.size else measured
    words = []
    for value in ends:
        number = value / unit
        is_usual = np.isclose(abs(number), _MARKS, rtol=1e-6, atol=0).any()
        others = measured[measured != value]
        # Both ends may be marks, as of a converter that saturates.
        between = others[~np.isin(others, ends)]
        rest = between if between.size >= _FEWEST else others
        spread = np.ptp(rest) if rest.size else np.inf
        gap = np.abs(rest - value).min(initial=np.inf)
        # Heights that differ by rounding are one.
        is_far = rest is between and gap > _FAR * spread > 1e-9 * gap
        if is_far or (gap > spread and (is_usual or is_steep)) or (is_usual and is_steep):
            count = measured.size - others.size
            points = f"{count} point{'s' * (count > 1)} of {number:.10g}"
            words.append(f"{points}: if they mark missing points, write nan")
    return words


class FromArray(Component):
    """A component whose values are those of a file or an array, for which a hash stands."""

    content: ClassVar[str]
    """What the values are, in messages."""

    sha256: str | None = Field(
        None, title="hash", description="hash of the file or array; verified if given"
    )
    _values: Array = PrivateAttr()
    _digest: str = PrivateAttr()

    def _keep(self, values: Array, digest: str, name: str) -> None:
        """Store the values, and the hash of the file or array ``name`` that holds them."""
        if self.sha256 not in (None, digest):
            raise ConfigError(
                f"{self.sha256} is not the hash {digest} of the {self.content} of {name}: they "
                "have changed; remove sha256 to use them as they are",
                "sha256",
            )
        values.setflags(write=False)
        self._values, self._digest = values, digest

    @model_serializer(mode="wrap")
    def _with_hash(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        fields: dict[str, Any] = handler(self)
        return {"sha256": self._digest} | fields | {"sha256": self._digest}

    def __eq__(self, other: object) -> bool:
        """Compare the configurations, in which the hash stands for the values."""
        return type(other) is type(self) and self.model_dump() == other.model_dump()

    def __hash__(self) -> int:
        """Return a hash that agrees with equality."""
        return hash((type(self), self._digest))


class FromHeights(FromArray, Indenter):
    """Rough punch given by heights, whose peaks touch first; it ends at the edge of the domain."""

    footprint: ClassVar[Footprint] = "domain"
    content: ClassVar[str] = "heights"
