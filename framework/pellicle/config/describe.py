"""The fields of a configuration: one walk, for explanations, pages, figures and documentation."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, Literal, NamedTuple, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pellicle.components import Component, HasForceCurve, Table
from pellicle.components.installed import registry
from pellicle.errors import ConfigError, PluginError
from pellicle.grid import Grid
from pellicle.plugins.component import words_of_type
from pellicle.plugins.origins import Origin
from pellicle.units import parts_of, quantity_of, readable
from pellicle.variables import words_of_name

from .legs import LoadSteps, legs_with
from .loading import Loading, keys_of, prescription_in


class FieldRow(NamedTuple):
    """A field of a configuration."""

    name: str
    """Dotted path, as in ``--set``; without values, ``[]`` stands for the entries of a list."""
    part: str
    """Words of the table that it is in, such as "kernel"."""
    words: str
    """Words of the field, such as "surface tension" or "thickness of layer 2"."""
    value: str
    """The value as text, with a unit that brings it near 1 … 1000; a component by its words.

    Empty for a field that is not set, for a table and for an entry of a list of values.
    """
    meaning: str
    unit: str = ""
    """SI unit, "1" of a pure number; empty for what is no number."""
    kind: str = ""
    """Allowed values: unit and bounds, or the kind of value."""
    default: str = ""
    """The default as a file would give it, or in words, such as "none" or "required"."""
    origin: Origin | None = None
    """Distribution and entry point of a component."""


def inputs(configuration: Mapping[str, Any], model: type[BaseModel]) -> Iterator[FieldRow]:
    """Yield the values of a configuration of a ``model`` such as `Run`, in the form of its JSON.

    Fields of components that are not installed have no unit.
    """
    return (row for row in field_rows(model.model_fields, configuration) if row.value)


def table_of(rows: Iterable[FieldRow], caption: str = "") -> Table:
    """Return each value of a configuration with its meaning, without the title."""
    cells = [
        (i.part, "type" if i.words == i.part else i.words, i.value, i.meaning)
        for i in rows
        if i.name != "title"
    ]
    return Table.of_rows(("of", "input", "value", "meaning"), cells, caption)


def words_at(configuration: Mapping[str, Any], model: type[BaseModel], key: str) -> str:
    """Return the words for the value at a dotted path of a configuration.

    ``configuration`` has the form of `Run.to_json`. A field of a component or of a table is named
    by its words alone, as in "surface tension"; deeper ones with what they belong to, as in
    "thickness of layer 2".
    """
    words = {row.name: row.words for row in field_rows(model.model_fields, configuration)}
    return words.get(key.removesuffix(".type")) or words_of_name(key)


_SNAKE = re.compile(r"\b[a-z]+(?:_[a-z]+)+\b")


def field_rows(
    fields: Mapping[str, FieldInfo],
    table: Mapping[str, Any] | None = None,
    path: str = "",
    part: str = "",
    owner: str = "",
) -> Iterator[FieldRow]:
    """Yield the fields of a table and of the tables in it, outer ones before inner ones.

    With the values of a ``table``, in the form of its JSON, these are the fields of its components
    too, and values that no field describes. Without, components and the tables that have an
    explanation of their own, grid and loading, are one field. Names begin with the ``path`` of the
    table, words end with those of its ``owner``.
    """
    values = table or {}
    for key in (*values, *(name for name in fields if name not in values)):
        if key == "type":
            continue
        info, value = fields.get(key), values.get(key)
        noun = field_words(key, info)
        meaning = (info.description if info else None) or ""
        quantity = quantity_of(info) if info else None
        unit = quantity.unit if quantity else ""
        facts = (unit, _kind_of(info), _default_of(info)) if info else ()
        row = FieldRow(f"{path}{key}", part or noun, _with_owner(noun, owner), "", meaning, *facts)
        if table is None:
            yield row
            inner = model_in(info.annotation) if info else None
            if info and inner and not issubclass(inner, (Component, Grid, Loading)):
                is_list = not {tuple, list}.isdisjoint(map(get_origin, parts_of(info.annotation)))
                start = f"{row.name}{'[]' * is_list}."
                yield from field_rows(inner.model_fields, None, start, row.part)
            continue
        # Other fields that it names are named in words.
        meaning = _SNAKE.sub(lambda match: field_words(match[0], fields.get(match[0])), meaning)
        row = row._replace(meaning=meaning)
        if isinstance(value, Mapping):
            yield from _table(row, value, info, row.words if path else "")
            continue
        tables = isinstance(value, list) and all(isinstance(entry, Mapping) for entry in value)
        if isinstance(value, bool):
            row = row._replace(value="yes" if value else "no")
        elif value is not None and not tables:
            row = row._replace(value=readable(value, unit))
        yield row
        for index, entry in enumerate(value if isinstance(value, list) else ()):
            words = _with_owner(_entry(noun, info, tables, index), owner)
            inner_row = row._replace(name=f"{row.name}.{index}", words=words, value="")
            yield from _table(inner_row, entry, info, words) if tables else [inner_row]


def _table(
    row: FieldRow, table: Mapping[str, Any], info: FieldInfo | None, owner: str
) -> Iterator[FieldRow]:
    """Yield the row of the table of a component or of another part of the run, and those in it."""
    model = model_in(info.annotation) if info else None
    fields: Mapping[str, FieldInfo] = model.model_fields if model else {}
    if steps := _load_steps(info):
        kinds = legs_with(steps.quantity).items()
        fields = next((kind.model_fields for key, kind in kinds if key in table), {})
    elif "type" in table:
        type_, family = str(table["type"]), getattr(model, "family", "")
        if entry := registry().components.get(family, {}).get(type_):
            words, fields = words_of_type(entry.component, type_), entry.component.model_fields
            row = row._replace(value=words, meaning=entry.summary, origin=entry.origin)
        else:
            row, fields = row._replace(value=words_of_name(type_), meaning=""), {}
    elif model is Loading:
        with suppress(ConfigError, PluginError):
            fields = keys_of(prescription_in(table))
    yield row
    yield from field_rows(fields, table, f"{row.name}.", row.part, owner)


def field_words(name: str, field: FieldInfo | None) -> str:
    """Return the words of a field: its title, or its name without underscores."""
    return (field.title if field else None) or words_of_name(name)


def _with_owner(noun: str, owner: str) -> str:
    """Return "thickness of layer 1", "tension of the substrate" or, without owner, the noun."""
    numbered = owner.partition(" of ")[0][-1:].isdigit()
    return f"{noun} of {'' if numbered else 'the '}{owner}" if owner else noun


def _entry(noun: str, field: FieldInfo | None, tables: bool, index: int) -> str:
    """Return words for an entry of a list: "size along x" of a pair, "layer 2" of ``tables``."""
    choices = (field.annotation, *get_args(field.annotation)) if field else ()
    items = [get_args(choice) for choice in choices if get_origin(choice) is tuple]
    if index < 2 and any(len(types) == 2 and ... not in types for types in items):
        return f"{noun} along {'xy'[index]}"
    if tables:
        noun = "leg" if _load_steps(field) else noun.removesuffix("s")
    return f"{noun} {index + 1}"


_KINDS: Mapping[Any, str] = {
    bool: "true or false",
    int: "whole number",
    float: "number",
    str: "text",
    Path: "file",
    Any: "array",
    HasForceCurve: "force curve",
}
_BOUNDS = (">", "gt"), ("≥", "ge"), ("<", "lt"), ("≤", "le")


def _kind_of(info: FieldInfo) -> str:
    """Return what a field takes: unit and bounds of a quantity, or its kind of value."""
    if quantity := quantity_of(info):
        return ", ".join(["number" if quantity.unit == "1" else quantity.unit, *quantity.bounds])
    bounds = [
        f"{sign} {bound}"
        for entry in info.metadata
        for sign, name in _BOUNDS
        if (bound := getattr(entry, name, None)) is not None
    ]
    return ", ".join([_kind(info.annotation), *bounds])


def _kind(annotation: Any) -> str:
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin is Literal:
        return " or ".join(json.dumps(value, ensure_ascii=False) for value in parts)
    if origin is Annotated:
        return _kind(parts[0])
    type_ = origin or annotation
    if isinstance(type_, type) and issubclass(type_, (BaseModel, Mapping)):
        return "table"
    if not parts:
        return next((_KINDS[base] for base in getattr(type_, "__mro__", ()) if base in _KINDS), "")
    kinds = [_kind(part) for part in parts if part not in (NoneType, ..., Any)]
    text = " or ".join(filter(None, dict.fromkeys(kinds)))
    if origin not in (tuple, list):
        return text
    plural = "s" * (text in ("table", "text", "file", "number", "whole number"))
    return f"list of {text}{plural}" if text else "list"


def _default_of(info: FieldInfo) -> str:
    """Return the default of a field as a file would give it, or in words such as "none"."""
    if info.is_required():
        return "required"
    if getattr(info, "default_factory_takes_validated_data", False):
        return "from other fields"
    value = info.get_default(call_default_factory=True)
    if value is None or value in ((), "", {}):
        return getattr(quantity_of(info), "left_out", "none")
    if isinstance(value, Component):
        return value.type_name
    if isinstance(value, BaseModel):
        return "see below"
    if (quantity := quantity_of(info)) and quantity.unit != "1":
        return readable(value, quantity.unit)
    return json.dumps(value, ensure_ascii=False, default=str)


def _load_steps(field: FieldInfo | None) -> LoadSteps | None:
    return next((m for m in field.metadata if isinstance(m, LoadSteps)), None) if field else None


def model_in(annotation: Any) -> type[BaseModel] | None:
    """Return the model that a field holds, alone or in a list."""
    types = (part for part in parts_of(annotation) if isinstance(part, type))
    return next((type_ for type_ in types if issubclass(type_, BaseModel)), None)
