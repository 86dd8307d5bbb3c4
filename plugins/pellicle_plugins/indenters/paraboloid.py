"""The paraboloid of revolution."""

from __future__ import annotations

from math import inf
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import ForceCurve
from pellicle.units import Length
from pellicle_plugins.axisymmetric import master_curves
from pellicle_plugins.axisymmetric.layer_curves import Profile, smooth_profile

from .of_revolution import Axisymmetric
from .sphere import Sphere


class Paraboloid(Axisymmetric):
    """Paraboloid of revolution, as in the theory of Hertz: the shallow limit of a sphere."""

    type: Literal["paraboloid"] = "paraboloid"
    examples = ({"radius": "1 mm"},)
    radius: Annotated[Length, Field(description="radius of curvature R at the tip [m]")]

    def profile(self, x: Array, y: Array) -> Array:
        """Return −(x² + y²)/2R [m]."""
        # 2R of the largest double would be infinite and the paraboloid flat.
        return -(x**2 + y**2) / 2 / self.radius

    contact_radius_limit: ClassVar[float] = inf
    pointed: ClassVar[bool] = False

    def abel_slope(self, x: Array) -> Array:
        """Return h'(x) = 2x/R for contact radii x [m]; see `HasAbelTransform`."""
        return 2 * x / self.radius

    def _master_curve(self, depth: Array, length: float) -> ForceCurve:
        return master_curves.paraboloid(self.radius, depth, length)

    def _make_layer_curves(self) -> Profile:
        return smooth_profile(self.radius, inf, self.abel_slope)

    def whole_shape(self) -> Sphere:
        """Return the sphere of the same radius."""
        return Sphere(radius=self.radius)
