"""The sphere, exactly."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import ForceCurve
from pellicle.units import Length
from pellicle_plugins.axisymmetric import master_curves
from pellicle_plugins.axisymmetric.layer_curves import Profile, smooth_profile

from .of_revolution import Axisymmetric


class Sphere(Axisymmetric):
    """Sphere with its exact profile up to its equator."""

    type: Literal["sphere"] = "sphere"
    examples = ({"radius": "0.4 mm"},)
    radius: Annotated[Length, Field(description="radius R [m]")]

    def profile(self, x: Array, y: Array) -> Array:
        """Return √(R² − x² − y²) − R [m], −inf beyond the equator."""
        square = x**2 + y**2
        distance = np.sqrt(square)
        inside = distance <= self.radius
        # R² − r² as a product does not overflow.
        root = np.sqrt(self.radius - distance, where=inside, out=np.zeros_like(distance))
        root *= np.sqrt(self.radius + distance)
        # root − R would cancel near the tip, −r²/(R + root) does not.
        shape = -(square / self.radius) / (1 + root / self.radius)
        return np.where(inside, shape, -np.inf)

    @property
    def depth_limit(self) -> float:
        """Depth R at which the equator is reached [m]."""
        return self.radius

    pointed: ClassVar[bool] = False

    @property
    def contact_radius_limit(self) -> float:
        """R [m]: no contact is wider than the equator."""
        return self.radius

    def abel_slope(self, x: Array) -> Array:
        """Return h'(x), h = x artanh(x/R), for contact radii x [m]; see `HasAbelTransform`."""
        u = x / self.radius
        return np.arctanh(u) + u / ((1 - u) * (1 + u))

    def _master_curve(self, depth: Array, length: float) -> ForceCurve:
        return master_curves.sphere(self.radius, depth, length)

    def _make_layer_curves(self) -> Profile:
        return smooth_profile(self.radius, self.radius, self.abel_slope)
