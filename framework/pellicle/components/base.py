"""The base class of all components, and fields that hold a component."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Final

from pydantic import GetCoreSchemaHandler, PlainSerializer, PlainValidator, WithJsonSchema
from pydantic.fields import FieldInfo
from pydantic_core import core_schema

from pellicle.schema.model import Model
from pellicle.variables import ROLE, words_of_name

FAMILY: Final = "x-pellicle-family"
"""Keyword of a JSON schema for a choice among the components of a family."""


class Component(Model):
    """A frozen model with a field ``type: Literal["…"]``, by which configurations name it."""

    family: ClassVar[str]
    """Name of its family, which the base class of the family alone gives."""
    place: ClassVar[str]
    """Where a file has components of the family; ``[]`` stands for an entry of a list."""
    libraries: ClassVar[tuple[str, ...]] = ()
    """Distributions that it uses besides numpy and scipy; results record their versions."""

    also: ClassVar[tuple[str, ...]] = ()
    """Other words for it, or for what it comes nearest to, with which a message leads to it."""

    @property
    def type_name(self) -> str:
        """The component's type, such as ``half_space``."""
        # A base class with a field ``type: str`` would not let components narrow it to a literal.
        return str(getattr(self, "type", type(self).__name__))


def words_of_type(component: type[Component], type_: str) -> str:
    """Return the words of a component for figures and tables.

    These are the ``title`` of its own ``model_config``, or its type without underscores.
    """
    title = component.model_config.get("title")
    inherited = {getattr(base, "model_config", {}).get("title") for base in component.__mro__[1:]}
    return title if title and title not in inherited else words_of_name(type_)


def role_of(field: FieldInfo) -> str:
    """Return the role of a component's field, such as `pellicle.variables.SEED`; "" without one."""
    extra = field.json_schema_extra
    return str(extra.get(ROLE, "")) if isinstance(extra, dict) else ""


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

        # `json_schema` replaces this keyword later: not all components are known while plugins
        # load, and a component may hold another one of its own family.
        choice = Annotated[Any, WithJsonSchema({FAMILY: source.family})]
        dump = PlainSerializer(
            lambda component, info: component.model_dump(
                mode=info.mode, exclude_none=info.exclude_none, context=info.context
            )
        )
        validate = PlainValidator(made, json_schema_input_type=choice)
        return handler.generate_schema(Annotated[source, validate, dump])
