"""Variables for readers: words, unit and digits, and whether they mean something."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Final

import numpy as np

from pellicle.arrays import Array, DataArray, Dataset
from pellicle.components.charts import Column
from pellicle.units import DIGITS
from pellicle.variables import CORRECTED_FRACTION, ROLE, SEED, WORDS, WORDS_OF_VALUES, words_of_name

_ALL_DIGITS = 15
_AXES: Final = {"semi_major_axis", "semi_minor_axis", "major_axis_angle"}
_OF_A_PERIOD: Final = {"contact_fraction", "mean_pressure"}
_ROUND: Final = 1e-9


def column_of(variable: DataArray) -> Column:
    """Return a variable or a coordinate of a result or a table as a column.

    Its attributes or, without them, its name give the words. The numbers of a coordinate have as
    many digits as distinguish them, four at least.
    """
    name, attributes, values = str(variable.name), variable.attrs, variable.values.ravel()
    is_number = variable.dtype.kind in "iuf"
    column = Column(
        str(attributes.get(WORDS, words_of_name(name))),
        values,
        str(attributes.get("units", "1")) if is_number else "",
        str(attributes.get("long_name", "")),
        name,
        texts=json.loads(attributes.get(WORDS_OF_VALUES, "{}")),
    )
    if is_number and variable.ndim == 1 and name in variable.coords:
        distinct = {*values.tolist()}
        for digits in range(DIGITS, _ALL_DIGITS):
            if len({column.scale.number(value, digits) for value in distinct}) == len(distinct):
                return replace(column, digits=digits)
        return replace(column, digits=_ALL_DIGITS)
    return column


def has_one_shape(data: Dataset) -> bool:
    """Return whether the contact is always in one part, which a radius and an ellipse describe."""
    return "patches" in data and not bool((data["patches"] > 1).any())


def is_periodic(data: Dataset) -> bool:
    """Return whether the domain of a result, or of some run of a study, repeats."""
    return bool(data.attrs["boundary"] == "periodic")


def has_meaning(data: Dataset, name: str) -> bool:
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


def is_ordered(table: Dataset, dim: str | None) -> bool:
    """Return whether the values along a dimension are numbers to compare, which seeds are not."""
    return (
        dim is not None
        and dim in table.coords
        and table[dim].dtype.kind in "if"
        and not is_seed(table[dim])
    )


def is_seed(axis: DataArray) -> bool:
    """Return whether the values of an axis only repeat a random run."""
    return bool(axis.attrs.get(ROLE) == SEED)


def is_log_spaced(values: Array) -> bool:
    """Return whether at least three positive values over half a decade grow by about even factors.

    Rounded series such as 1, 2, 5, 10 or 1, 3, 10 count too.
    """
    if values.size < 3 or values.min() <= 0 or values.max() < 4 * values.min():
        return False
    steps = np.diff(np.log(np.sort(values)))
    return bool(steps.max() <= 1.5 * steps.min())
