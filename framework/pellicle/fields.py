"""Fields that hold components, in a run and in a component made of others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic import BaseModel
from pydantic_core import core_schema

from .components import Component
from .plugins import registry

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic.json_schema import JsonSchemaValue


class FromRegistry:
    """Annotation of a field that holds a component: any registered one of the field's family."""

    def __get_pydantic_core_schema__(
        self, source: type[Component], handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(
            lambda given: registry().make(source, given),
            serialization=core_schema.plain_serializer_function_ser_schema(
                lambda component, info: component.model_dump(
                    mode=info.mode, exclude_none=info.exclude_none
                ),
                info_arg=True,
            ),
            metadata={"family": source.family},
        )

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        found = registry().components[schema["metadata"]["family"]]
        return {
            "oneOf": [
                handler(registered.component.__pydantic_core_schema__)
                | {"required": ["type", *_required(registered.component)]}
                for registered in found.values()
            ]
        }


def _required(model: type[BaseModel]) -> list[str]:
    return [name for name, info in model.model_fields.items() if info.is_required()]
