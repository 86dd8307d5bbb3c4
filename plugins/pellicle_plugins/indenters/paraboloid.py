"""The paraboloid of revolution."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Literal

from pydantic import Field

from pellicle import hookimpl
from pellicle.arrays import Array
from pellicle.components import ForceCurve, Indenter
from pellicle.units import Length
from pellicle_plugins.analytic import master_curves

from .sphere import Sphere


class Paraboloid(Indenter):
    """Paraboloid of revolution, as in the theory of Hertz: the shallow limit of a sphere."""

    type: Literal["paraboloid"] = "paraboloid"
    radius: Annotated[Length, Field(description="radius of curvature R at the tip [m]")]

    def profile(self, x: Array, y: Array) -> Array:
        """Return −(x² + y²)/2R [m]."""
        # Twice the largest radii would be infinite, and the paraboloid flat.
        return -(x**2 + y**2) / 2 / self.radius

    @property
    def depth_limit(self) -> float:
        """No limit."""
        return float("inf")

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return P/E* and its sensitivities from the master curve of the axisymmetric equation."""
        return master_curves.paraboloid(self.radius, depth, length)

    def whole_shape(self) -> Sphere:
        """Return the sphere of the same radius."""
        return Sphere(radius=self.radius)


@hookimpl
def register_indenters(register: Callable[[type[Indenter]], None]) -> None:
    """Register the paraboloid."""
    register(Paraboloid)
