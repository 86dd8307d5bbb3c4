"""The sphere, exactly."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from pellicle import hookimpl
from pellicle.arrays import Array
from pellicle.components import ForceCurve, Indenter
from pellicle.units import Length
from pellicle_plugins.analytic import master_curves


class Sphere(Indenter):
    """Sphere with its exact profile, not the paraboloid's; nothing beyond its equator."""

    type: Literal["sphere"] = "sphere"
    radius: Annotated[Length, Field(description="radius R [m]")]

    def profile(self, x: Array, y: Array) -> Array:
        """Return √(R² − x² − y²) − R [m], −inf beyond the equator."""
        square = x**2 + y**2
        distance = np.sqrt(square)
        inside = distance <= self.radius
        # R² − r² as a product, which does not overflow.
        root = np.sqrt(self.radius - distance, where=inside, out=np.zeros_like(distance))
        root *= np.sqrt(self.radius + distance)
        # −r²/(R + root) instead of root − R, which cancels near the tip.
        shape = -(square / self.radius) / (1 + root / self.radius)
        return np.where(inside, shape, -np.inf)

    @property
    def depth_limit(self) -> float:
        """R, the equator [m]."""
        return self.radius

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return P/E* and its sensitivities from the master curve of the axisymmetric equation."""
        return master_curves.sphere(self.radius, depth, length)


@hookimpl
def register_indenters(register: Callable[[type[Indenter]], None]) -> None:
    """Register the sphere."""
    register(Sphere)
