"""Tensions of a skin that may be stretched more one way than the other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, Final, Self

from pydantic import Field, GetJsonSchemaHandler, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import core_schema

from pellicle.arrays import Array
from pellicle.errors import ConfigError, excerpt
from pellicle.schema import Model
from pellicle.units import Quantity


class OneOrTwo(Quantity):
    """A quantity, or two of them; two equal ones are one."""

    def __call__(self, value: object) -> Any:
        """Return a value in SI, or a pair of them."""
        if not isinstance(value, Sequence) or isinstance(value, str):
            return super().__call__(value)
        if len(value) != 2:
            raise ValueError(f"{excerpt(value)} is not allowed; give one value, or a list of two")
        first, second = map(super().__call__, value)
        return first if first == second else (first, second)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        single = super().__get_pydantic_json_schema__(schema, handler)
        pair = {"type": "array", "items": single, "minItems": 2, "maxItems": 2}
        return {"anyOf": [*single["anyOf"], pair], "unit": self.unit}


Tensions = Annotated[float | tuple[float, float], OneOrTwo("N/m", at_least=0)]
"""A surface tension ≥ 0 [N/m], or that along a direction and that across it."""


TENSION: Final[Any] = {
    "title": "surface tension",
    "description": "tension τ₀ of the surface [N/m], 0 for none; on a periodic boundary also two, "
    "[along, across] a direction",
}


class SkinTensions(Model):
    """A skin under tension, which may be tensed more one way: k = qᵀTq."""

    tension: Tensions = Field(**TENSION)
    angle: Annotated[float, Quantity("rad")] | None = Field(
        None,
        description="angle of the first of two tensions from x to y [rad], or as '30 degree'; "
        "along x if not given",
    )

    @property
    def has_one_tension(self) -> bool:
        """Whether the tension is the same in all directions."""
        return not isinstance(self.tension, tuple)

    @property
    def one_tension(self) -> float:
        """The tension [N/m] if it is the same in all directions."""
        if isinstance(self.tension, tuple):
            raise ConfigError(
                "has a tension that differs with the direction, so one function of |q| does not "
                "describe it; use symbol(qx, qy)",
                "kernel",
            )
        return self.tension

    def tension_stiffness(self, qx: Array, qy: Array) -> Array:
        """Return T₁ q∥² + T₂ q⊥² [Pa/m], with q∥ along the angle and q⊥ across it."""
        along, across = self.tension if isinstance(self.tension, tuple) else (self.tension,) * 2
        cos, sin = math.cos(self.angle or 0.0), math.sin(self.angle or 0.0)
        stiffness: Array = along * (cos * qx + sin * qy) ** 2 + across * (cos * qy - sin * qx) ** 2
        return stiffness

    @model_validator(mode="after")
    def _check_angle(self) -> Self:
        if self.angle is not None and self.has_one_tension:
            raise ConfigError(
                "is given, and the tension is the same in all directions; leave it out, or give "
                "two tensions",
                "angle",
            )
        return self
