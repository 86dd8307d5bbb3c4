"""The flat-ended cylinder."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import ForceCurve
from pellicle.units import Length
from pellicle_plugins.axisymmetric import master_curves
from pellicle_plugins.axisymmetric.layer_curves import Punch

from .of_revolution import Axisymmetric


class FlatPunch(Axisymmetric):
    """Flat-ended circular cylinder of the cells whose centres lie under it."""

    type: Literal["flat_punch"] = "flat_punch"
    examples = ({"radius": "0.3 mm"},)
    radius: Annotated[Length, Field(description="radius of the flat end [m]")]

    def profile(self, x: Array, y: Array) -> Array:
        """Return 0 under the punch and −inf beside it [m]."""
        return np.where(x**2 + y**2 <= self.radius**2, 0.0, -np.inf)

    def _master_curve(self, depth: Array, length: float) -> ForceCurve:
        return master_curves.flat_punch(self.radius, depth, length)

    def _make_layer_curves(self) -> Punch:
        return Punch(self.radius)
