"""The JSON schema of run and study files, and of models whose fields hold components."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from pellicle.components import Component
from pellicle.components.installed import FAMILY, registry

from .run import Run
from .study import Study

_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_IN_PART = "InPart"


def model_schema(model: type[BaseModel]) -> dict[str, Any]:
    """Return the JSON schema of a model whose fields take any installed component.

    It holds the families that the model refers to, itself or by components of another family. In
    fields of the model itself the schemas of the components are written out. Components may hold
    others of their own family without end, so their fields refer to schemas.
    """
    models, referred_to = [model], [model]
    while referred_to:
        refs, generated = models_json_schema([(entry, "validation") for entry in models])
        referred_to = [entry for entry in _referred_to(generated) if entry not in models]
        models += dict.fromkeys(referred_to)
    names = {entry: refs[entry, "validation"]["$ref"].rpartition("/")[2] for entry in models}
    definitions: dict[str, Any] = generated["$defs"]
    referred: dict[str, list[dict[str, Any]]] = defaultdict(list)
    written: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for component in models[1:]:
        if issubclass(component, Component):
            fields = (name for name, info in component.model_fields.items() if info.is_required())
            required = {"required": ["type", *fields]}
            referred[component.family].append(refs[component, "validation"] | required)
            written[component.family].append(definitions[names[component]] | required)
    top = _filled(_filled(definitions.pop(names[model]), written), referred)
    return {"$defs": _filled(definitions, referred), **top}


def _referred_to(schema: Any) -> Iterator[type[BaseModel]]:
    """Yield the components that a schema refers to."""
    if isinstance(schema, dict):
        for entry in registry().components.get(schema.get(FAMILY, ""), {}).values():
            yield entry.component
        schema = [*schema.values()]
    if isinstance(schema, list):
        for inner in schema:
            yield from _referred_to(inner)


def _filled(schema: Any, choices: dict[str, list[dict[str, Any]]]) -> Any:
    """Return ``schema`` with the choices of a family in place of its keyword."""
    if isinstance(schema, list):
        return [_filled(inner, choices) for inner in schema]
    if not isinstance(schema, dict):
        return schema
    filled = {name: _filled(inner, choices) for name, inner in schema.items() if name != FAMILY}
    if FAMILY not in schema:
        return filled
    # A list of choices must not be empty, which it is where no plugin of a family could be loaded.
    choice = choices[schema[FAMILY]]
    if not choice:
        return filled | {"not": {}}
    return filled | {"oneOf": choice}


def json_schema(model: type[BaseModel] = Run) -> dict[str, Any]:
    """Return the JSON schema of a run or study file, or of the file of another model.

    It has all installed components. A study file may leave out varied fields, so only the type of a
    component is required there.
    """
    if model is not Run:
        return {"$schema": _DIALECT, **model_schema(model)}
    run, study = model_schema(Run), model_schema(Study)
    definitions = run.pop("$defs") | study.pop("$defs")
    study["properties"].pop("run")
    study["required"] = []
    file = _in_part(run)
    file["properties"]["study"] = study
    return {
        "$schema": _DIALECT,
        **file,
        "if": {"required": ["study"]},
        "else": run,
        "$defs": definitions
        | {f"{name}{_IN_PART}": _in_part(inner) for name, inner in definitions.items()},
    }


def _in_part(schema: Any) -> Any:
    """Return a schema that also accepts objects with missing fields."""
    if isinstance(schema, list):
        return [_in_part(inner) for inner in schema]
    if not isinstance(schema, dict):
        return schema
    part = {n: _in_part(inner) for n, inner in schema.items() if not _requires_any(inner)}
    if isinstance(required := schema.get("required"), list):
        part["required"] = [name for name in required if name == "type"]
    if isinstance(ref := schema.get("$ref"), str):
        part["$ref"] = f"{ref}{_IN_PART}"
    return part


def _requires_any(choices: Any) -> bool:
    """Return whether these are alternative lists of required fields, as for elastic moduli."""
    return (
        isinstance(choices, list)
        and bool(choices)
        and all(isinstance(c, dict) and c.keys() == {"required"} for c in choices)
    )
