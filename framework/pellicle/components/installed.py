"""The components that are installed: by the name of their type, and as fields of models."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import cache
from importlib.metadata import entry_points
from typing import Annotated, Any, Final

from pydantic import GetCoreSchemaHandler, PlainSerializer, PlainValidator, WithJsonSchema
from pydantic_core import core_schema

from pellicle.plugins.component import Component
from pellicle.plugins.origins import DISABLE, GROUP
from pellicle.plugins.registry import AnyComponent, Registry, load

from .correction import AreaCorrection
from .executor import Executor
from .indenter import Indenter
from .interaction import Interaction
from .kernel import Kernel
from .load import Load
from .output import Output
from .prescription import Prescription
from .solver import Solver

_OWN: Final = (
    *(Kernel, Indenter, Load, Interaction, Solver),
    *(AreaCorrection, Output, Executor, Prescription),
)
FAMILIES: Final[dict[str, type[Component]]] = {base.family: base for base in _OWN}
"""The base class of each of pellicle's own families, by name."""
FAMILY: Final = "x-pellicle-family"
"""Keyword of a JSON schema for a choice among the components of a family."""


@cache
def registry() -> Registry:
    """Return the registry of all installed plugins."""
    return load(entry_points(group=GROUP), os.environ.get(DISABLE, ""), known=FAMILIES)


def _factory(family: type[AnyComponent], example: str) -> Callable[..., AnyComponent]:
    def make(type: str, /, **fields: Any) -> AnyComponent:  # noqa: A002 - name of the field
        return registry().make(family, {"type": type, **fields})

    name = family.family
    make.__name__ = make.__qualname__ = name
    make.__doc__ = f"""Return the {name} of a type with its fields, such as ``{name}({example})``.

    A type that does not exist, or fields that it does not allow, are a ConfigError.
    """
    return make


kernel = _factory(Kernel, '"half_space", reduced_modulus="10 kPa"')
indenter = _factory(Indenter, '"sphere", radius="5 um"')
interaction = _factory(Interaction, '"jkr", work_of_adhesion="50 mJ/m2"')
solver = _factory(Solver, '"conjugate_gradient", tolerance=1e-6')


class FromRegistry:
    """Annotation of a field that holds an installed component of the field's family.

    ``kernel: Annotated[Kernel, FromRegistry()]`` takes a table with ``type`` and the fields of that
    component, or the component itself.
    """

    def __get_pydantic_core_schema__(
        self, source: type[Component], handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        def made(value: object) -> Component:
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
