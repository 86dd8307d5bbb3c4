"""The words for the fields and components of a configuration, in figures, tables and pages."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from typing import Any, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pellicle.components import Component
from pellicle.components.base import words_of_type
from pellicle.errors import ConfigError, PluginError
from pellicle.loading import LoadSteps
from pellicle.model.legs import KINDS, fields_of
from pellicle.plugins import Registered, registry
from pellicle.results.variables import words_of_name
from pellicle.units import quantity_of

from .loading import Loading, model_of


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
            noun = _entry(noun, field, table, int(name))
            if field is not None and _is_leg(field, table):
                noun = f"leg {int(name) + 1}"
            entries = table if isinstance(table, list) else []
            table = entries[int(name)] if int(name) < len(entries) else None
        else:
            owner = _with_owner(noun, owner) if depth > 1 else ""
            leg = fields_of_leg(table, field) if field is not None and inner is None else {}
            field = inner.model_fields.get(name) if inner else leg.get(name)
            noun = field_words(name, field)
            table = table.get(name) if isinstance(table, Mapping) else None
        is_table = isinstance(table, Mapping)
        inner = model_of_table(table, field.annotation if field else None) if is_table else None
    return _with_owner(noun, owner)


def _with_owner(noun: str, owner: str) -> str:
    """Return "thickness of layer 1", "tension of the substrate" or, without owner, the noun."""
    numbered = owner.partition(" of ")[0][-1:].isdigit()
    return f"{noun} of {'' if numbered else 'the '}{owner}" if owner else noun


def _entry(noun: str, field: FieldInfo | None, values: object, index: int) -> str:
    """Return words for an entry of a list: "size along x" of a pair, "layer 2" of tables."""
    if field is not None and index < 2 and _is_pair(field):
        return f"{noun} along {'xy'[index]}"
    tables = isinstance(values, list) and any(isinstance(value, Mapping) for value in values)
    return f"{noun.removesuffix('s') if tables else noun} {index + 1}"


def _is_leg(field: FieldInfo, values: object) -> bool:
    steps = any(isinstance(annotation, LoadSteps) for annotation in field.metadata)
    return steps and isinstance(values, list) and any(isinstance(v, Mapping) for v in values)


def fields_of_leg(leg: object, info: FieldInfo) -> Mapping[str, FieldInfo]:
    """Return the fields of a leg of the load steps described by ``info``; none of another table."""
    quantity = quantity_of(info)
    if not isinstance(leg, Mapping) or quantity is None:
        return {}
    kind = next((kind for kind in KINDS if kind.key in leg), None)
    return fields_of(kind, quantity.unit) if kind else {}


def _is_pair(field: FieldInfo) -> bool:
    choices = (field.annotation, *get_args(field.annotation))
    return any(
        get_origin(choice) is tuple and len(get_args(choice)) == 2 and ... not in get_args(choice)
        for choice in choices
    )


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
            return model_of(table)
    return model


def model_in(annotation: Any) -> type[BaseModel] | None:
    """Return the model that a field holds, alone or in a list."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next(filter(None, map(model_in, get_args(annotation))), None)


def type_words(model: type[BaseModel] | None, type_: str) -> str:
    """Return the words of a component, which need not be installed."""
    entry = registered(model, type_)
    return words_of_type(entry.component, type_) if entry else words_of_name(type_)
