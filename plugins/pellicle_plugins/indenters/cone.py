"""The cone."""

from __future__ import annotations

from math import inf, pi, tan
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import ForceCurve
from pellicle.units import Quantity
from pellicle_plugins.axisymmetric import master_curves
from pellicle_plugins.axisymmetric.layer_curves import Profile, cone_profile

from .of_revolution import Axisymmetric


class Cone(Axisymmetric):
    """Cone with its tip down."""

    type: Literal["cone"] = "cone"
    examples = ({"half_angle": "70 degree"},)
    half_angle: Annotated[
        float,
        Quantity("rad", above=0, below=pi / 2),
        Field(
            title="half-angle", description="angle between axis and side [rad], or as '70 degree'"
        ),
    ]

    def profile(self, x: Array, y: Array) -> Array:
        """Return −r cot α [m]."""
        return -np.hypot(x, y) / tan(self.half_angle)

    contact_radius_limit: ClassVar[float] = inf
    pointed: ClassVar[bool] = True

    def abel_slope(self, x: Array) -> Array:
        """Return h' = (π/2) cot α for contact radii x [m]; see `HasAbelTransform`."""
        return np.full_like(x, pi / 2 / tan(self.half_angle))

    def _master_curve(self, depth: Array, length: float) -> ForceCurve:
        return master_curves.cone(self.half_angle, depth, length)

    def _make_layer_curves(self) -> Profile:
        return cone_profile(self.half_angle)
