"""Fields that hold components, in a run and in a component made of others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from pydantic_core import core_schema

from pellicle.components import Component
from pellicle.plugins import registry

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
