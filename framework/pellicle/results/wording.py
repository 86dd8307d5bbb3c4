"""Which variables mean something, and how figures and tables show them: words, unit, digits."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from numbers import Real
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from pellicle.arrays import Array
from pellicle.components.charts import Column
from pellicle.units import DIGITS, NOTHING, Scale, axis_unit, printed
from pellicle.variables import (
    CORRECTED_FRACTION,
    VARIABLES,
    WORDS,
    WORDS_OF_VALUES,
    words_of_name,
)

if TYPE_CHECKING:
    import xarray as xr

_SI_DIGITS, _ALL_DIGITS = 6, 15
_AXES: Final = {"semi_major_axis", "semi_minor_axis", "major_axis_angle"}
_OF_A_PERIOD: Final = {"contact_fraction", "mean_pressure"}
_ROUND: Final = 1e-9


@dataclass(frozen=True)
class Wording:
    """A variable as figures and tables show it: in words, and in one unit for all values."""

    words: str
    """Such as "contact radius"."""
    scale: Scale
    digits: int = DIGITS
    """Significant digits of its numbers."""
    texts: Mapping[str, str] = field(default_factory=dict)
    """Words for values that are texts, such as types of components."""

    @classmethod
    def of(cls, column: Column, *, si: bool = False) -> Wording:
        """Return how a column is shown.

        Its largest number gives the prefix of its unit, which with ``si`` has none; then its
        numbers have six digits.
        """
        if si:
            unit = "" if column.unit == "1" else printed(column.unit)
            return cls(column.words, Scale(1.0, unit), _SI_DIGITS)
        values: Any = column.values
        if not isinstance(values, np.ndarray):
            values = [value for value in values if isinstance(value, Real)]
        return cls(column.words, axis_unit(values, column.unit), column.digits)

    @property
    def head(self) -> str:
        """Words and unit, for an axis or a column: "contact radius [µm]"."""
        return f"{self.words} [{self.scale.unit}]" if self.scale.unit else self.words

    def number(self, value: object) -> str:
        """Return a value in SI as text in the unit, without it."""
        if isinstance(value, str):
            return self.texts.get(value, value)
        return self.scale.number(value, self.digits)

    def text(self, value: object) -> str:
        """Return words, value and unit: "surface tension 30 mN/m"."""
        number = self.number(value)
        return f"{self.words} {number if number == NOTHING else self.scale.with_unit(number)}"

    def listing(self, values: Iterable[object]) -> str:
        """Return several values in SI as a list with the unit; of many, some are left out."""
        return self.scale.listing([self.number(value) for value in values])


def column_of(variable: xr.DataArray) -> Column:
    """Return a variable or a coordinate of a result or a table as a column.

    Its attributes or, without them, its name give the words. The numbers of a coordinate have as
    many digits as distinguish them, four at least.
    """
    name, attributes, values = str(variable.name), variable.attrs, variable.values.ravel()
    words, unit = str(attributes.get(WORDS, words_of_name(name))), str(attributes.get("units", "1"))
    meaning = str(attributes.get("long_name", ""))
    if variable.dtype.kind not in "iuf":
        texts = json.loads(attributes.get(WORDS_OF_VALUES, "{}"))
        mapped = [texts.get(value, value) for value in values.tolist()] if texts else values
        return Column(words, mapped, "", meaning, name)
    is_axis = variable.ndim == 1 and name in variable.coords
    digits = _digits(values, axis_unit(values, unit)) if is_axis else DIGITS
    return Column(words, values, unit, meaning, name, digits)


def column_of_name(name: str, values: Sequence[float]) -> Column:
    """Return values of a variable of `VARIABLES` as a column."""
    variable = VARIABLES[name]
    return Column(variable.words, values, variable.unit, variable.meaning, name)


def wording(variable: xr.DataArray) -> Wording:
    """Return how a variable or a coordinate of a result or a table is shown."""
    texts = json.loads(variable.attrs.get(WORDS_OF_VALUES, "{}"))
    return replace(Wording.of(column_of(variable)), texts=texts)


def shown(column: Column, *, si: bool = False) -> tuple[str, list[str]]:
    """Return the unit of a column and its cells, as people read them; empty for no unit."""
    how = Wording.of(column, si=si)
    values = column.values
    listed = values.tolist() if isinstance(values, np.ndarray) else values
    return how.scale.unit, [how.number(value) for value in listed]


def _digits(values: Array, scale: Scale) -> int:
    """Return the number of digits that distinguish values, at least `DIGITS`."""
    distinct = {*values.tolist()}
    for digits in range(DIGITS, _ALL_DIGITS):
        if len({scale.number(value, digits) for value in distinct}) == len(distinct):
            return digits
    return _ALL_DIGITS


def has_one_shape(data: xr.Dataset) -> bool:
    """Return whether the contact is always in one part, which a radius and an ellipse describe."""
    return "patches" in data and not bool((data["patches"] > 1).any())


def is_periodic(data: xr.Dataset) -> bool:
    """Return whether the domain of a result, or of some run of a study, repeats."""
    return bool(data.attrs["boundary"] == "periodic")


def means_something(data: xr.Dataset, name: str) -> bool:
    """Return whether a variable has a meaning for the contacts of a result or of a study.

    A contact in several parts has neither radius nor ellipse, and a round one no axes besides its
    radius. On a free domain the area of the domain is arbitrary, and so is a share of it.
    """
    if name in {"contact_radius", *_AXES} and not has_one_shape(data):
        return False
    if name in _AXES:
        major, minor = data["semi_major_axis"].values, data["semi_minor_axis"].values
        return bool(np.any(major - minor > _ROUND * major))
    if name in _OF_A_PERIOD or name.startswith(CORRECTED_FRACTION):
        return is_periodic(data)
    return True
