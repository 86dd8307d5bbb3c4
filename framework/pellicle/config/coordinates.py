"""The values of the axes of a study, as coordinates of its table and as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from pellicle.model.base import Model
from pellicle.model.input_path import AS_GIVEN
from pellicle.model.input_path import as_given as path_as_given
from pellicle.model.paths import get, walk
from pellicle.model.ranges import Values
from pellicle.units import quantity_of

from .points import short
from .run import Run


class Coordinate(NamedTuple):
    """The values that a parameter takes along a dimension."""

    values: np.ndarray[tuple[int], np.dtype[Any]]
    """Numbers in SI, or texts."""
    attributes: dict[str, str]
    """Attributes of the coordinate: its unit and meaning."""


def coordinate(key: str, given: Values, runs: Sequence[Run]) -> Coordinate:
    """Return the values that ``runs`` hold of the parameter ``key``, ``given`` by the user."""
    values = [_single(get(run, key), value) for run, value in zip(runs, given, strict=True)]
    attributes = {"long_name": key}
    if all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values):
        if unit := _unit(runs[0], key):
            attributes["units"] = unit
        return Coordinate(np.array(values), attributes)
    texts = [
        value if isinstance(value, str) else short(original)
        for value, original in zip(values, given, strict=True)
    ]
    if len(set(texts)) < len(texts):
        texts = [json.dumps(as_json(*pair)) for pair in zip(given, values, strict=True)]
    return Coordinate(np.array(texts, dtype=object), attributes)


def as_json(given: Any, value: Any, *, as_given: bool = False) -> Any:
    """Return a ``given`` value in a form that JSON can hold.

    ``value`` is the validated value of the run, whose paths replace the given ones: absolute or, if
    ``as_given``, as the user wrote them.
    """
    if isinstance(given, Model):
        context = AS_GIVEN if as_given else None
        return given.model_dump(mode="json", exclude_none=True, context=context)
    if isinstance(value, Path):
        return path_as_given(value) if as_given else str(value)
    if isinstance(given, Mapping):
        return {
            name: as_json(inner, get(value, name), as_given=as_given)
            for name, inner in given.items()
        }
    if isinstance(given, (list, tuple)):
        return [
            as_json(inner, get(value, str(index)), as_given=as_given)
            for index, inner in enumerate(given)
        ]
    if hasattr(given, "tolist"):
        return given.tolist()
    return given if isinstance(given, (str, int, float, bool)) else str(given)


def _single(value: Any, given: Any) -> Any:
    """Return one of several equal values if the user gave one, as for a size or a depth."""
    several = isinstance(value, tuple) and value and len(set(map(str, value))) == 1
    if several and not isinstance(given, (list, tuple, Mapping)):
        return value[0]
    return path_as_given(value) if isinstance(value, Path) else value


def _unit(run: Run, key: str) -> str | None:
    """Return the SI unit of the field at a dotted key."""
    field = next((field for path, _, field in walk(run) if path == key), None)
    quantity = quantity_of(field) if field else None
    # Attributes of datasets write m2 for m**2 of pint.
    return quantity.unit.replace("m**2", "m2") if quantity else None
