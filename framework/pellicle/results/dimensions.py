"""The names of the dimensions of a study's table, in files and in Python."""

from __future__ import annotations

import json
from collections.abc import Hashable, Iterable, Iterator

import numpy as np

from pellicle.arrays import Dataset
from pellicle.schema.model import python_names

PARAMETER = "parameter"
"""Attribute of a coordinate of `with_python_names`: the dotted path of the parameter."""


def parts(table: Dataset, dimensions: Iterable[Hashable]) -> Iterator[Dataset]:
    """Yield the part of a table at each combination of indices along dimensions, in C order."""
    dimensions = list(dimensions)
    for index in np.ndindex(*(table.sizes[dim] for dim in dimensions)):
        yield table.isel(dict(zip(dimensions, index, strict=True)))


def with_python_names(table: Dataset) -> Dataset:
    """Return a table whose dimensions have names that Python can write, such as kernel_tension.

    Expressions and outputs name a parameter by its dotted path. It stays the name of a second
    coordinate with an index, for ``table["kernel.tension"]`` and ``sel`` with a mapping.
    """
    axes, names = _axes_and_names(table)
    table = table.rename_dims({dim: names[dim] for dim in axes if names[dim] != dim})
    for dim, keys in axes.items():
        for key in keys:
            name, axis = names[key], table[key]
            if name == key:
                continue
            described = axis.attrs | {PARAMETER: key}
            table = table.assign_coords({name: (names[dim], axis.values, described)})
            if key != dim:
                table = table.set_xindex(name)
    return table


def with_paths(table: Dataset) -> Dataset:
    """Return a table whose dimensions are the dotted paths of their parameters, as in run files."""
    axes, names = _axes_and_names(table)
    renamed = {names[dim]: dim for dim in axes if names[dim] != dim and names[dim] in table.dims}
    copies = [name for key, name in names.items() if name != key and name in table.coords]
    # An index keeps the dimension with which it was made; swap_dims makes a new one.
    stale = [dim for dim in renamed.values() if dim in table.xindexes]
    return table.drop_vars(copies).drop_indexes(stale).swap_dims(renamed)


def _axes_and_names(table: Dataset) -> tuple[dict[str, list[str]], dict[str, str]]:
    """Return the parameters along each dimension, and the name in Python of each parameter."""
    axes: dict[str, list[str]] = json.loads(table.attrs.get("axes", "{}"))
    return axes, python_names([key for keys in axes.values() for key in keys])
