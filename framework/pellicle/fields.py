"""Fields that hold components, in a run and in a component made of others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from pydantic import BaseModel
from pydantic.json_schema import models_json_schema
from pydantic_core import core_schema

from .components import Component
from .plugins import registry

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic.json_schema import JsonSchemaValue

# Keyword of a JSON schema that stands for a choice among the components of a family.
_FAMILY: Final = "x-pellicle-family"


class FromRegistry:
    """Annotation of a field that holds a component: any registered one of the field's family."""

    def __get_pydantic_core_schema__(
        self, source: type[Component], handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(
            lambda given: registry().make(source, given),
            serialization=core_schema.plain_serializer_function_ser_schema(
                lambda component, info: component.model_dump(
                    mode=info.mode, exclude_none=info.exclude_none, context=info.context
                ),
                info_arg=True,
            ),
            metadata={"family": source.family},
        )

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        # `json_schema` fills it in: while plugins load nobody knows what there will be, and a
        # component may hold one of its own family.
        inner: Any = schema
        # A validator of the model that has the field is wrapped around it.
        while "family" not in inner.get("metadata", {}):
            inner = inner["schema"]
        return {_FAMILY: inner["metadata"]["family"]}


def json_schema(model: type[BaseModel]) -> dict[str, Any]:
    """Return the JSON schema of a model whose fields take any component that is installed.

    Where such a field is the model's own the components are written out; within components, which
    may hold others of their own family without end, they are referred to.
    """
    families = registry().components
    installed = [each for found in families.values() for each in found.values()]
    models = [model, *(registered.component for registered in installed)]
    refs, made = models_json_schema([(each, "validation") for each in models])
    names = {each: refs[each, "validation"]["$ref"].rpartition("/")[2] for each in models}
    definitions: dict[str, Any] = made["$defs"]
    referred: dict[str, list[dict[str, Any]]] = {family: [] for family in families}
    written: dict[str, list[dict[str, Any]]] = {family: [] for family in families}
    for registered in installed:
        component = registered.component
        required = {"required": ["type", *_required(component)]}
        referred[component.family].append(refs[component, "validation"] | required)
        written[component.family].append(definitions[names[component]] | required)
    top = _filled(_filled(definitions.pop(names[model]), written), referred)
    return {"$defs": _filled(definitions, referred), **top}


def _filled(schema: Any, choices: dict[str, list[dict[str, Any]]]) -> Any:
    """Return ``schema`` with the choices of a family wherever a field holds one of them."""
    if isinstance(schema, list):
        return [_filled(each, choices) for each in schema]
    if not isinstance(schema, dict):
        return schema
    filled = {name: _filled(each, choices) for name, each in schema.items() if name != _FAMILY}
    return filled | {"oneOf": choices[schema[_FAMILY]]} if _FAMILY in schema else filled


def _required(model: type[BaseModel]) -> list[str]:
    return [name for name, info in model.model_fields.items() if info.is_required()]
