"""What a run was told: each value of its configuration with its unit, its meaning, its origin."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, get_args

from pydantic import BaseModel

from pellicle.components import Component
from pellicle.plugins import Origin, Registered, registry
from pellicle.units import quantity_of, readable

from .run import Run


class Input(NamedTuple):
    """One value of a configuration."""

    name: str
    """Dotted path, as after ``--set``."""
    value: str
    """With its unit, brought near 1 … 1000."""
    meaning: str
    origin: Origin | None = None
    """Where a component comes from."""


def inputs(configuration: Mapping[str, Any]) -> Iterator[Input]:
    """Yield the inputs of a run, given as `Run.to_json` says it.

    What no installed component explains is there too, without a unit.
    """
    yield from _table(configuration, Run, "")


def _table(said: Mapping[str, Any], model: type[BaseModel] | None, path: str) -> Iterator[Input]:
    fields = model.model_fields if model else {}
    for key, value in said.items():
        info = fields.get(key)
        name = f"{path}{key}"
        if isinstance(value, Mapping):
            yield from _one(value, info.annotation if info else None, name)
        elif isinstance(value, list) and value and all(isinstance(v, Mapping) for v in value):
            for index, each in enumerate(value):
                yield from _one(each, info.annotation if info else None, f"{name}.{index}")
        elif value not in ([], ""):
            quantity = quantity_of(info) if info else None
            words = readable(value, quantity.unit if quantity else "1")
            yield Input(name, words, (info.description if info else None) or "")


def _one(said: Mapping[str, Any], annotation: Any, name: str) -> Iterator[Input]:
    """Yield the inputs in a table: a component, or a part of the run."""
    model = _model(annotation)
    if "type" not in said:
        yield from _table(said, model, f"{name}.")
        return
    found = _registered(model, said["type"])
    summary, origin = (found.summary, found.origin) if found else ("", None)
    yield Input(name, str(said["type"]), summary, origin)
    inner = {key: value for key, value in said.items() if key != "type"}
    yield from _table(inner, found.component if found else None, f"{name}.")


def _registered(model: type[BaseModel] | None, type_: object) -> Registered | None:
    if model is None or not issubclass(model, Component):
        return None
    return registry().components[model.family].get(str(type_))


def _model(annotation: Any) -> type[BaseModel] | None:
    """Return the model that a field holds, alone or in a list."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for inner in get_args(annotation) if (found := _model(inner))), None)
