"""The configuration of a run as rows of value with unit, meaning, and origin of components."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any, NamedTuple, get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pellicle.components import Component
from pellicle.errors import ConfigError, PluginError
from pellicle.loading import LoadSteps
from pellicle.model.legs import KINDS, fields_of
from pellicle.plugins import Origin, Registered, registry
from pellicle.units import quantity_of, readable

from .loading import Loading, model_of
from .run import Run


class Input(NamedTuple):
    """One value of a configuration."""

    name: str
    """Dotted path, as in ``--set``."""
    value: str
    """The value as text, with a unit that brings it near 1 … 1000."""
    meaning: str
    origin: Origin | None = None
    """Distribution and entry point of a component."""


def inputs(configuration: Mapping[str, Any]) -> Iterator[Input]:
    """Yield the values of a configuration in the form of `Run.to_json`.

    Fields of components that are not installed have no unit.
    """
    yield from _table(configuration, Run.model_fields, "")


def _table(table: Mapping[str, Any], fields: Mapping[str, FieldInfo], path: str) -> Iterator[Input]:
    for key, value in table.items():
        info = fields.get(key)
        name = f"{path}{key}"
        if isinstance(value, Mapping):
            yield from _one(value, info.annotation if info else None, name)
        elif isinstance(value, list) and value and all(isinstance(v, Mapping) for v in value):
            for index, entry in enumerate(value):
                if info and any(isinstance(m, LoadSteps) for m in info.metadata):
                    yield from _table(entry, _fields_of_leg(entry, info), f"{name}.{index}.")
                else:
                    yield from _one(entry, info.annotation if info else None, f"{name}.{index}")
        elif value not in ([], ""):
            quantity = quantity_of(info) if info else None
            text = readable(value, quantity.unit if quantity else "1")
            yield Input(name, text, (info.description if info else None) or "")


def _one(table: Mapping[str, Any], annotation: Any, name: str) -> Iterator[Input]:
    """Yield the values in the table of a component or of another part of the run."""
    model = _model(annotation)
    if "type" not in table:
        if model is Loading:
            with suppress(ConfigError, PluginError):
                model = model_of(table)
        yield from _table(table, model.model_fields if model else {}, f"{name}.")
        return
    known = _registered(model, table["type"])
    summary, origin = (known.summary, known.origin) if known else ("", None)
    yield Input(name, str(table["type"]), summary, origin)
    inner = {key: value for key, value in table.items() if key != "type"}
    yield from _table(inner, known.component.model_fields if known else {}, f"{name}.")


def _fields_of_leg(leg: Mapping[str, Any], info: FieldInfo) -> Mapping[str, FieldInfo]:
    """Return the fields of a leg of the load steps described by ``info``."""
    quantity = quantity_of(info)
    kind = next((kind for kind in KINDS if kind.key in leg), None)
    return fields_of(kind, quantity.unit) if kind and quantity else {}


def _registered(model: type[BaseModel] | None, type_: object) -> Registered | None:
    if model is None or not issubclass(model, Component):
        return None
    return registry().components[model.family].get(str(type_))


def _model(annotation: Any) -> type[BaseModel] | None:
    """Return the model that a field holds, alone or in a list."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next(filter(None, map(_model, get_args(annotation))), None)
