"""Fields that hold a component."""

from __future__ import annotations

from typing import Any, Final

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import core_schema

from .base import Component

FAMILY: Final = "x-pellicle-family"
"""Keyword of a JSON schema for a choice among the components of a family."""


class FromRegistry:
    """Annotation of a field that holds an installed component of the field's family.

    ``kernel: Annotated[Kernel, FromRegistry()]`` takes a table with ``type`` and the fields of that
    component, or the component itself.
    """

    def __get_pydantic_core_schema__(
        self, source: type[Component], handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        def made(value: object) -> Component:
            from pellicle.plugins import registry

            return registry().make(source, value)

        return core_schema.no_info_plain_validator_function(
            made,
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
        # `json_schema` replaces this keyword later: not all components are known while plugins
        # load, and a component may hold another one of its own family.
        inner: Any = schema
        # Validators of the model wrap the schema of the field.
        while "family" not in inner.get("metadata", {}):
            inner = inner["schema"]
        return {FAMILY: inner["metadata"]["family"]}
