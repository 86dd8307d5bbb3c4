"""An indenter shifted sideways."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from pellicle.arrays import Array
from pellicle.units import Quantity

from .transformed import RigidMotion, profile_of


class Shifted(RigidMotion):
    """Another indenter moved sideways, off the centre of the domain."""

    type: Literal["shifted"] = "shifted"
    x: Annotated[
        float, Quantity("m"), Field(title="shift along x", description="shift along x [m]")
    ] = 0.0
    y: Annotated[
        float, Quantity("m"), Field(title="shift along y", description="shift along y [m]")
    ] = 0.0

    def profile(self, x: Array, y: Array) -> Array:
        """Return f(x − x₀, y − y₀) [m]."""
        return profile_of(self.part, x - self.x, y - self.y, "part")
