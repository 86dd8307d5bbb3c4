"""The general quadric."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import Indenter
from pellicle.units import Length


class Quadric(Indenter):
    """Paraboloid with different radii of curvature along x and y."""

    type: Literal["quadric"] = "quadric"
    examples = ({"radius_x": "1 mm", "radius_y": "2 mm"},)
    radius_x: Length = Field(
        title="radius along x", description="radius of curvature in the x–z plane [m]"
    )
    radius_y: Length = Field(
        title="radius along y", description="radius of curvature in the y–z plane [m]"
    )

    def profile(self, x: Array, y: Array) -> Array:
        """Return −(x²/2R_x + y²/2R_y) [m]."""
        return -(x**2 / 2 / self.radius_x + y**2 / 2 / self.radius_y)
