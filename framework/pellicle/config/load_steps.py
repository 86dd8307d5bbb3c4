"""The values of load steps: one value, a list, a ramp or legs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sized
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

from pydantic_core import core_schema

from pellicle.errors import ConfigError, all_problems, shown
from pellicle.schema.ranges import RANGE, SPACINGS, ranged
from pellicle.units import Quantity

from .legs import KINDS, Leg, legs_of, with_quantity

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic.json_schema import JsonSchemaValue


@dataclass(frozen=True)
class LoadSteps:
    """Annotation of load steps: one value, a list, or a ramp, which may return to its start."""

    quantity: Quantity
    legs: bool = False
    """Whether a list of legs is allowed too."""

    def __call__(self, spec: object) -> tuple[float, ...] | tuple[Leg, ...]:
        """Return the load steps in order, SI, or their legs."""
        if isinstance(spec, Mapping):
            return self._ramp(spec)
        # Lists, tuples and arrays have a length; text, and arrays of one number, have one too.
        several = isinstance(spec, Sized) and not isinstance(spec, str)
        several = several and getattr(spec, "ndim", 1) > 0
        values = list(cast("Iterable[object]", spec)) if several else [spec]
        if not values:
            raise ValueError("is empty; give at least one load step")
        if self.legs and any(isinstance(value, (Mapping, Leg)) for value in values):
            return legs_of(values, self.quantity)
        return self._all({str(i) if several else "": value for i, value in enumerate(values)})

    def _ramp(self, table: Mapping[Any, Any]) -> tuple[float, ...]:
        if self.legs and any(kind.key in table for kind in KINDS):
            raise ConfigError("is one leg; give a list of legs, [ { … } ]")
        back = table.get("back", False)
        if not isinstance(back, bool):
            raise ConfigError(f"{shown(back)} is not allowed; give true or false", "back")
        once = {key: value for key, value in table.items() if key != "back"}
        ends = {end: once[end] for end in ("start", "stop") if end in once}
        once |= zip(ends, self._all(ends), strict=True)
        values = ranged(once, "ramp", 'back = true or spacing = "log"')
        return values + values[-2::-1] if back else values

    def _all(self, values_by_place: Mapping[str, object]) -> tuple[float, ...]:
        """Return all values in SI, or raise an error that names all values not allowed."""
        values = []
        with all_problems() as within:
            for where, value in values_by_place.items():
                with within(where):
                    values.append(self.quantity(value))
        return tuple(values)

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        value_schema = self.quantity.__get_pydantic_json_schema__(schema, handler)
        ramp = {
            "type": "object",
            "properties": {
                "start": value_schema,
                "stop": value_schema,
                "num": {"type": "integer", "minimum": 2},
                "spacing": {"enum": list(SPACINGS)},
                "back": {"type": "boolean"},
            },
            "required": sorted(RANGE),
            "additionalProperties": False,
        }
        legs = [with_quantity(kind, self.quantity).model_json_schema() for kind in KINDS]
        several: list[dict[str, Any]] = [
            {"type": "array", "items": items, "minItems": 1}
            for items in (value_schema, {"anyOf": legs})
        ]
        return {"anyOf": [value_schema, ramp, *several[: 1 + self.legs]]}
