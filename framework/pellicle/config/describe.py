"""The configuration of a run as rows of value with unit, meaning, and origin of components."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pellicle.components.base import words_of_type
from pellicle.plugins import Origin
from pellicle.units import quantity_of, readable
from pellicle.variables import words_of_name

from .words import field_words, fields_of_table, model_in, registered, words_at


class Input(NamedTuple):
    """One value of a configuration."""

    name: str
    """Dotted path, as in ``--set``."""
    part: str
    """Words of the table that it is in, such as "kernel"."""
    words: str
    """Words of the field, such as "surface tension"."""
    value: str
    """The value as text, with a unit that brings it near 1 … 1000; a component by its words."""
    meaning: str
    origin: Origin | None = None
    """Distribution and entry point of a component."""


def inputs(configuration: Mapping[str, Any], model: type[BaseModel]) -> Iterator[Input]:
    """Yield the values of a configuration of a ``model`` such as `Run`, in the form of its JSON.

    Fields of components that are not installed have no unit.
    """
    for name, value, meaning, origin in _table(configuration, model.model_fields, ""):
        top = name.partition(".")[0]
        part = field_words(top, model.model_fields.get(top))
        yield Input(name, part, words_at(configuration, model, name), value, meaning, origin)


_SNAKE = re.compile(r"\b[a-z]+(?:_[a-z]+)+\b")
_Row = tuple[str, str, str, Origin | None]


def _table(table: Mapping[str, Any], fields: Mapping[str, FieldInfo], path: str) -> Iterator[_Row]:
    for key, value in table.items():
        info, name = fields.get(key), f"{path}{key}"
        if isinstance(value, Mapping):
            yield from _rows_of(value, info, name)
        elif isinstance(value, list) and value and all(isinstance(v, Mapping) for v in value):
            for index, entry in enumerate(value):
                yield from _rows_of(entry, info, f"{name}.{index}")
        elif value not in ([], ""):
            quantity = quantity_of(info) if info else None
            text = readable(value, quantity.unit if quantity else "1")
            if isinstance(value, bool):
                text = "yes" if value else "no"
            description = (info.description if info else None) or ""
            # Other fields that it names are named in words.
            meaning = _SNAKE.sub(lambda m: field_words(m[0], fields.get(m[0])), description)
            yield name, text, meaning, None


def _rows_of(table: Mapping[str, Any], info: FieldInfo | None, name: str) -> Iterator[_Row]:
    """Yield the values in the table of a component or of another part of the run."""
    if "type" in table:
        type_ = str(table["type"])
        if entry := registered(model_in(info.annotation) if info else None, type_):
            yield name, words_of_type(entry.component, type_), entry.summary, entry.origin
        else:
            yield name, words_of_name(type_), "", None
    inner = {key: value for key, value in table.items() if key != "type"}
    yield from _table(inner, fields_of_table(table, info), f"{name}.")
