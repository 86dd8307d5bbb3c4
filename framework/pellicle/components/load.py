"""The contract of loads: known tractions on the surface, without an indenter."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, ClassVar, Final, NamedTuple, Self, get_origin

from pydantic import (
    GetJsonSchemaHandler,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    field_validator,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from pellicle.arrays import Array
from pellicle.errors import ConfigError
from pellicle.plugins.component import Component
from pellicle.schema.model import replace_at, walk
from pellicle.schema.ranges import is_path, path_of, path_schemas
from pellicle.units import parts_of, quantity_of
from pellicle.variables import VARIABLES, Variable, words_of_name

_OF_FIELD: Final = {"title", "description", "default"}
"""Keywords of the schema of a field that are not those of its value."""


class LoadPath(NamedTuple):
    """The field of a load that varies over the load steps."""

    name: str
    """Its dotted path, such as ``radius`` or ``parts.0.radius``."""
    values: tuple[float, ...]
    """Its value in each step, SI."""
    variable: Variable
    """The variable of a result that holds it."""


class Load(Component):
    """A known traction on the surface.

    One field that is a number may be a list or a ramp of values: a run then has a step for each,
    and `traction` is asked of a load with one value.
    """

    family: ClassVar[str] = "load"
    place: ClassVar[str] = "load"

    @abstractmethod
    def traction(self, x: Array, y: Array) -> Array:
        """Return the traction on each cell [Pa], positive into the solid; it may pull.

        ``x`` of shape (nx, 1) and ``y`` of shape (1, ny) are coordinates of the cell centres [m]
        from the centre of the domain; the result has shape (nx, ny). Its sum times the area of a
        cell is the force. A load that has no traction on these cells raises a ConfigError.
        """

    @property
    def has_line_without_width(self) -> bool:
        """Whether it has a line force that is as wide as the cells, for want of a width."""
        return False

    def cells_across(self, dx: float, dy: float) -> float:
        """Return how many cells of dx × dy [m] lie across its finest part; infinite if it has none.

        Asked of a load with one value of each field. Where it is below 4 the step says so.
        """
        return float("inf")

    @property
    def varying_field(self) -> LoadPath | None:
        """The field that varies; None if none does."""
        return next(iter(self._paths), None)

    def at(self, step: int) -> Self:
        """Return the load in a load step, counted from 0, each of its fields one value."""
        if (path := self.varying_field) is None:
            return self
        return type(self)(**replace_at(self, path.name, path.values[step]))

    @property
    def _paths(self) -> list[LoadPath]:
        paths = []
        for name, value, field in walk(self):
            if field and isinstance(value, tuple) and _is_number(field):
                quantity, last = quantity_of(field), name.rpartition(".")[2]
                unit = quantity.unit if quantity else "1"
                meaning = (field.description or "").partition(" [")[0]
                title = (field.title or words_of_name(last)) + " of the load" * (last in VARIABLES)
                variable = Variable(f"load_{last}", unit, meaning, "main", title=title)
                paths.append(LoadPath(name, value, variable))
        return paths

    @field_validator("*", mode="wrap", check_fields=False)
    @classmethod
    def _read_path(
        cls, value: object, make: ValidatorFunctionWrapHandler, info: ValidationInfo
    ) -> Any:
        field = cls.model_fields[str(info.field_name)]
        quantity = quantity_of(field)
        is_several = quantity and _is_number(field) and is_path(value)
        return path_of(value, quantity) if quantity and is_several else make(value)

    @model_validator(mode="after")
    def _one_path(self) -> Self:
        paths = self._paths
        if len(paths) > 1:
            raise ConfigError(
                f"varies over the load steps, and so does {paths[0].name}; only one field of a "
                "load may: give one value here, and vary it by [study.vary]",
                paths[1].name,
            )
        return self

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Return the schema with a list or a ramp in place of any number."""
        reference = handler(schema)
        whole = handler.resolve_ref_schema(reference)
        for name, field in cls.model_fields.items():
            if _is_number(field) and name in whole.get("properties", {}):
                own = whole["properties"][name]
                value = {key: own.pop(key) for key in own.keys() - _OF_FIELD}
                own["anyOf"] = path_schemas(value)
        return reference


def _is_number(field: FieldInfo) -> bool:
    """Return whether a field is one number with a unit."""
    parts = parts_of(field.annotation)
    is_list = not {tuple, list}.isdisjoint(map(get_origin, parts))
    return quantity_of(field) is not None and float in parts and not is_list
