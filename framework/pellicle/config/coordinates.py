"""The values of the axes of a study, as coordinates of its table and as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from pellicle.components import Component
from pellicle.plugins.component import role_of, words_of_type
from pellicle.schema.from_file import PORTABLE
from pellicle.schema.model import Model, get, walk
from pellicle.schema.ranges import Values
from pellicle.units import DIGITS, quantity_of, readable, split
from pellicle.variables import ROLE, WORDS, WORDS_OF_VALUES, words_of_name

from .describe import field_rows, field_words
from .run import Run


class Coordinate(NamedTuple):
    """The values that a parameter takes along a dimension."""

    values: np.ndarray[tuple[int], np.dtype[Any]]
    """Numbers in SI, or texts."""
    attributes: dict[str, str]
    """Attributes of the coordinate: its unit and meaning."""


def coordinate(key: str, inputs: Values, runs: Sequence[Run]) -> Coordinate:
    """Return the values that ``runs`` hold of the parameter ``key``, of the user's ``inputs``."""
    values = [_single(get(run, key), value) for run, value in zip(runs, inputs, strict=True)]
    rows = {row.name: row for row in field_rows(Run.model_fields, runs[0].to_table())}
    row = rows.get(key.removesuffix(".type"))
    words = (row and row.words) or words_of_name(key)
    attributes = {"long_name": words, WORDS: words}
    roles = (role_of(field) for path, _, field in walk(runs[0]) if path == key and field)
    if role := next(roles, ""):
        attributes[ROLE] = role
    if all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values):
        if row and row.unit:
            attributes["units"] = row.unit
        return Coordinate(np.array(values), attributes)
    texts = [
        value if isinstance(value, str) else short(original)
        for value, original in zip(values, inputs, strict=True)
    ]
    if len(set(texts)) < len(texts):
        texts = [json.dumps(as_json(*pair)) for pair in zip(inputs, values, strict=True)]
    shown = _words_of_values(key, values, runs)
    if shown != texts:
        by_value = dict(zip(texts, shown, strict=True))
        attributes[WORDS_OF_VALUES] = json.dumps(by_value, ensure_ascii=False)
    return Coordinate(np.array(texts, dtype=object), attributes)


def tell_apart(axes: Mapping[str, Coordinate]) -> None:
    """Add the name of their table to the words of axes that would otherwise have equal words."""
    words = [axis.attributes[WORDS] for axis in axes.values()]
    for key, axis in axes.items():
        if words.count(axis.attributes[WORDS]) > 1:
            table = field_words(top := key.partition(".")[0], Run.model_fields.get(top))
            axis.attributes[WORDS] += f" of the {table}"
            axis.attributes["long_name"] = axis.attributes[WORDS]


def _words_of_values(key: str, values: Sequence[Any], runs: Sequence[Run]) -> list[str]:
    """Return words for values that are not numbers; a component is named by its words.

    Components of one type are told apart by their fields.
    """
    if key.endswith(".type"):
        key = key.removesuffix(".type")
        values = [get(run, key) for run in runs]
    types = [
        words_of_type(type(value), value.type_name) if isinstance(value, Component) else ""
        for value in values
    ]
    several = len({*types}) < len(types)
    texts = []
    for words, value in zip(types, values, strict=True):
        text = words or _text(value)
        for name in value.model_fields_set - {"type"} if words and several else ():
            info = type(value).model_fields[name]
            unit = quantity.unit if (quantity := quantity_of(info)) else "1"
            text += f", {field_words(name, info)} {readable(getattr(value, name), unit, DIGITS)}"
        texts.append(text)
    return texts


def _text(value: Any) -> str:
    """Return a value that is not a component as words, each entry of a list by its numbers."""
    if isinstance(value, (tuple, list)):
        return " × ".join(map(_text, value))
    return value if isinstance(value, str) else readable(value, digits=DIGITS)


def as_json(entry: Any, value: Any, *, portable: bool = False) -> Any:
    """Return an ``entry`` of the user in a form that JSON can hold.

    ``value`` is the validated value of the run, whose absolute paths replace those of the entry
    unless the text is to be ``portable``.
    """
    if isinstance(entry, Model):
        context = PORTABLE if portable else None
        return entry.model_dump(mode="json", exclude_none=True, context=context)
    if isinstance(value, Path):
        return str(entry if portable else value)
    if isinstance(entry, Mapping):
        return {n: as_json(inner, get(value, n), portable=portable) for n, inner in entry.items()}
    if isinstance(entry, (list, tuple)):
        return [
            as_json(inner, get(value, str(index)), portable=portable)
            for index, inner in enumerate(entry)
        ]
    if hasattr(entry, "tolist"):
        return entry.tolist()
    return entry if isinstance(entry, (str, int, float, bool)) else str(entry)


def _single(value: Any, entry: Any) -> Any:
    """Return one of several equal values if the user gave one, as for a size or a depth."""
    several = isinstance(value, tuple) and value and len(set(map(str, value))) == 1
    if several and not isinstance(entry, (list, tuple, Mapping)):
        return value[0]
    return str(entry) if isinstance(value, Path) else value


def short(value: object) -> str:
    """Return a value as short text for the name of a run."""
    if isinstance(value, Model):
        value = {"type": getattr(value, "type_name", "?")}
    if isinstance(value, Mapping):
        return str(value.get("type", "{…}"))
    text = value if isinstance(value, str) else json.dumps(value, default=str)
    if (parts := split(text)) is not None:
        text = f"{parts[0]:.6g} {parts[1]}".rstrip()
    return text if len(text) <= 30 else f"{text[:29]}…"


def units_of(run: Run) -> dict[str, str]:
    """Return the SI unit of each field with one, by dotted path."""
    rows = field_rows(Run.model_fields, run.to_table())
    return {row.name: row.unit for row in rows if row.unit}
