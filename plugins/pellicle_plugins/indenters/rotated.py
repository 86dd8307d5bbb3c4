"""An indenter rotated about the vertical."""

from __future__ import annotations

from math import cos, sin
from typing import Annotated, Literal

from pydantic import Field

from pellicle.arrays import Array
from pellicle.units import Quantity

from .transformed import RigidMotion, profile_of


class Rotated(RigidMotion):
    """Another indenter rotated about the vertical through the centre of the domain."""

    type: Literal["rotated"] = "rotated"
    angle: Annotated[
        float,
        Quantity("rad"),
        Field(description="angle [rad] from x towards y, or as '30 degree'"),
    ]

    def profile(self, x: Array, y: Array) -> Array:
        """Return f(x cos α + y sin α, y cos α − x sin α) [m]."""
        c, s = cos(self.angle), sin(self.angle)
        return profile_of(self.part, c * x + s * y, c * y - s * x, "part")
