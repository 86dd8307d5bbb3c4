"""The words for the fields and components of a configuration, in figures, tables and pages."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from typing import Any, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pellicle.components import Component
from pellicle.errors import ConfigError, PluginError
from pellicle.loading import LoadSteps
from pellicle.plugins import Registered, registry
from pellicle.schema.legs import KINDS, fields_of
from pellicle.variables import words_of_name

from .loading import Loading, loading_model, prescribed_in


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
    inner: type[BaseModel] | None = model
    field: FieldInfo | None = None
    for depth, name in enumerate(key.split(".")):
        if name == "type" and depth:
            break
        if name.isdecimal():
            entries = table if isinstance(table, list) else []
            table = entries[int(name)] if int(name) < len(entries) else None
            is_leg = bool(fields_of_leg(table, field))
            noun = f"leg {int(name) + 1}" if is_leg else _entry(noun, field, entries, int(name))
        else:
            owner = _with_owner(noun, owner) if depth > 1 else ""
            field = (inner.model_fields if inner else fields_of_leg(table, field)).get(name)
            noun = field_words(name, field)
            table = table.get(name) if isinstance(table, Mapping) else None
        is_table = isinstance(table, Mapping)
        inner = model_of_table(table, field.annotation if field else None) if is_table else None
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
    return f"{noun.removesuffix('s') if tables else noun} {index + 1}"


def fields_of_leg(leg: object, info: FieldInfo | None) -> Mapping[str, FieldInfo]:
    """Return the fields of a leg of the load steps described by ``info``; none of another table."""
    steps = next((m for m in info.metadata if isinstance(m, LoadSteps)), None) if info else None
    if steps and isinstance(leg, Mapping):
        for kind in KINDS:
            if kind.key in leg:
                return fields_of(kind, steps.quantity.unit)
    return {}


def registered(model: type[BaseModel] | None, type_: object) -> Registered | None:
    """Return the installed component of a type, if ``model`` is the base class of its family."""
    if model is None or not issubclass(model, Component):
        return None
    return registry().components.get(model.family, {}).get(str(type_))


def model_of_table(table: Mapping[str, Any], annotation: Any) -> type[BaseModel] | None:
    """Return the model whose fields a table has, given the annotation of the field that holds it.

    None for components that are not installed.
    """
    model = model_in(annotation)
    if "type" in table:
        entry = registered(model, table["type"])
        return entry.component if entry else None
    if model is Loading:
        with suppress(ConfigError, PluginError):
            return loading_model(prescribed_in(table))
    return model


def model_in(annotation: Any) -> type[BaseModel] | None:
    """Return the model that a field holds, alone or in a list."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next(filter(None, map(model_in, get_args(annotation))), None)
