"""The configuration of a run in words, and as rows of value with unit, meaning and origin."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any, NamedTuple, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pellicle.components import Component
from pellicle.components.base import words_of_type
from pellicle.errors import ConfigError, PluginError
from pellicle.plugins import Origin, Registered, registry
from pellicle.units import quantity_of, readable
from pellicle.variables import words_of_name

from .load_steps import KINDS, LoadSteps, with_quantity
from .loading import Loading, keys_of, prescribed_in, prescriptions


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


def field_words(name: str, field: FieldInfo | None) -> str:
    """Return the words of a field: its title, or its name without underscores."""
    return (field.title if field else None) or words_of_name(name)


def words_at(configuration: Mapping[str, Any], model: type[BaseModel], key: str) -> str:
    """Return the words for the value at a dotted path of a configuration.

    ``configuration`` has the form of `Run.to_json`. A field of a component or of a table is named
    by its words alone, as in "surface tension"; deeper ones with what they belong to, as in
    "thickness of layer 2".
    """
    noun, owner = "", ""
    table: Any = configuration
    fields: Mapping[str, FieldInfo] = model.model_fields
    field: FieldInfo | None = None
    for depth, name in enumerate(key.split(".")):
        if name == "type" and depth:
            break
        if name.isdecimal():
            entries = table if isinstance(table, list) else []
            table = entries[int(name)] if int(name) < len(entries) else None
            noun = _entry(noun, field, entries, int(name))
        else:
            owner = _with_owner(noun, owner) if depth > 1 else ""
            field = fields.get(name)
            noun = field_words(name, field)
            table = table.get(name) if isinstance(table, Mapping) else None
        fields = fields_of_table(table, field) if isinstance(table, Mapping) else {}
    return _with_owner(noun, owner)


def _with_owner(noun: str, owner: str) -> str:
    """Return "thickness of layer 1", "tension of the substrate" or, without owner, the noun."""
    numbered = owner.partition(" of ")[0][-1:].isdigit()
    return f"{noun} of {'' if numbered else 'the '}{owner}" if owner else noun


def _entry(noun: str, field: FieldInfo | None, entries: list[Any], index: int) -> str:
    """Return words for an entry of a list: "size along x" of a pair, "layer 2" of tables."""
    choices = (field.annotation, *get_args(field.annotation)) if field else ()
    items = [get_args(choice) for choice in choices if get_origin(choice) is tuple]
    if index < 2 and any(len(types) == 2 and ... not in types for types in items):
        return f"{noun} along {'xy'[index]}"
    tables = any(isinstance(entry, Mapping) for entry in entries)
    if tables and _load_steps(field):
        return f"leg {index + 1}"
    return f"{noun.removesuffix('s') if tables else noun} {index + 1}"


def _load_steps(field: FieldInfo | None) -> LoadSteps | None:
    return next((m for m in field.metadata if isinstance(m, LoadSteps)), None) if field else None


def registered(model: type[BaseModel] | None, type_: object) -> Registered | None:
    """Return the installed component of a type, if ``model`` is the base class of its family."""
    if model is None or not issubclass(model, Component):
        return None
    return registry().components.get(model.family, {}).get(str(type_))


def fields_of_table(table: Mapping[str, Any], field: FieldInfo | None) -> Mapping[str, FieldInfo]:
    """Return the fields that a table has by name, given the field that holds it.

    A component that is not installed has none.
    """
    if steps := _load_steps(field):
        kind = next((kind for key, kind in KINDS.items() if key in table), None)
        return with_quantity(kind, steps.quantity).model_fields if kind else {}
    model: type[BaseModel] | None = model_in(field.annotation) if field else None
    if "type" in table:
        entry = registered(model, table["type"])
        model = entry.component if entry else None
    elif model is Loading:
        with suppress(ConfigError, PluginError):
            return keys_of(prescriptions()[prescribed_in(table)])
    return model.model_fields if model else {}


def model_in(annotation: Any) -> type[BaseModel] | None:
    """Return the model that a field holds, alone or in a list."""
    types = (part for part in parts_of(annotation) if isinstance(part, type))
    return next((type_ for type_ in types if issubclass(type_, BaseModel)), None)


def parts_of(annotation: Any) -> Iterator[Any]:
    """Yield an annotation, and those that it is made of."""
    yield annotation
    for part in get_args(annotation):
        yield from parts_of(part)
