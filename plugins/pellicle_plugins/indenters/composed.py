"""Indenters made of others: moved, turned, scaled or added."""

from __future__ import annotations

from math import cos, sin
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from pellicle.arrays import Array
from pellicle.components import Footprint, FromRegistry, Indenter, Lattice
from pellicle.errors import ConfigError, problems_within
from pellicle.units import Quantity

_Shift = Annotated[float, Quantity("m")]


class Composed(Indenter):
    """Base class of the indenters made of others, each of which repeats on a periodic grid."""

    def profile(self, x: Array, y: Array) -> Array:
        """Return the profile [m] of the indenter alone."""
        return self.repeated(x, y, None)


class Transformed(Composed):
    """Base class of the indenters that change one other, their ``part``."""

    part: Annotated[Indenter, FromRegistry()] = Field(
        description="the indenter to change: a table with type"
    )

    @property
    def footprint(self) -> Footprint:
        """The footprint of the part."""
        return self.part.footprint


class Shifted(Transformed):
    """Another indenter moved sideways, off the centre of the domain."""

    type: Literal["shifted"] = "shifted"
    examples = ({"part": {"type": "paraboloid", "radius": "1 mm"}, "x": "0.1 mm", "y": "-0.2 mm"},)
    x: _Shift = Field(0.0, title="shift along x", description="shift along x [m]")
    y: _Shift = Field(0.0, title="shift along y", description="shift along y [m]")

    def repeated(self, x: Array, y: Array, lattice: Lattice | None) -> Array:
        """Return f(x − x₀, y − y₀) [m]."""
        if lattice is None and self.part.footprint == "domain":
            raise ConfigError(
                "ends where the domain does and would leave a part of it empty; move the other "
                "parts of a sum instead, or press it on a periodic grid, where it goes on",
                "part",
            )
        return profile_of_part(self.part, x - self.x, y - self.y, lattice, "part")


class Rotated(Transformed):
    """Another indenter rotated about the vertical through the centre of the domain."""

    type: Literal["rotated"] = "rotated"
    examples = (
        {"part": {"type": "quadric", "radius_x": "1 mm", "radius_y": "2 mm"}, "angle": "30 degree"},
    )
    angle: Annotated[float, Quantity("rad")] = Field(
        description="angle [rad] from x towards y, or as '30 degree'"
    )

    @model_validator(mode="after")
    def _part_is_unbounded(self) -> Self:
        if self.part.footprint == "domain":
            raise ConfigError(
                "ends where the domain does and would leave a part of it empty; move the other "
                "parts of a sum instead, or the heights before they are read",
                "part",
            )
        return self

    def repeated(self, x: Array, y: Array, lattice: Lattice | None) -> Array:
        """Return f(x cos α + y sin α, y cos α − x sin α) [m]."""
        c, s = cos(self.angle), sin(self.angle)
        turned = lattice and lattice._replace(angle=lattice.angle - self.angle)
        return profile_of_part(self.part, c * x + s * y, c * y - s * x, turned, "part")


class Scaled(Transformed):
    """Another indenter with its heights multiplied by a factor."""

    type: Literal["scaled"] = "scaled"
    examples = (
        {"part": {"type": "heights", "path": "heights.txt", "unit": "1 um"}, "factor": 0.5},
    )
    factor: Annotated[float, Quantity("1", at_least=0)] = Field(
        title="height factor", description="factor of the heights; 0 is flat"
    )

    def repeated(self, x: Array, y: Array, lattice: Lattice | None) -> Array:
        """Return factor · f [m], or −inf where f is −inf."""
        profile = profile_of_part(self.part, x, y, lattice, "part")
        # −inf · 0 would be NaN.
        return np.multiply(profile, self.factor, out=profile.copy(), where=np.isfinite(profile))


def profile_of_part(
    part: Indenter, x: Array, y: Array, lattice: Lattice | None, field: str
) -> Array:
    """Return the profile [m] of the part in ``field``; its errors name that field."""
    with problems_within(field):
        return part.repeated(x, y, lattice)


class Sum(Composed):
    """Heights of several indenters added, such as roughness on a sphere.

    It ends at the edge of the domain if any of its parts does. Depth is measured from the lowest
    point of the sum, not of its parts.
    """

    type: Literal["sum"] = "sum"
    examples = (
        {
            "parts": [
                {"type": "sphere", "radius": "1 mm"},
                {"type": "quadric", "radius_x": "2 mm", "radius_y": "4 mm"},
            ]
        },
    )
    parts: tuple[Annotated[Indenter, FromRegistry()], ...] = Field(
        min_length=1, description="the indenters to add: tables with type"
    )

    @property
    def footprint(self) -> Footprint:
        """``"domain"`` if any part ends there."""
        return "domain" if any(part.footprint == "domain" for part in self.parts) else "unbounded"

    def repeated(self, x: Array, y: Array, lattice: Lattice | None) -> Array:
        """Return Σ f_i − its value at the lowest point [m].

        The lowest point of the sum of the unbounded parts is located between the cells. Parts that
        end with the domain are known at the cells only: the distance of their highest cell from 0
        is taken as that of the highest cell of the sum, correct to second order in the spacing.
        """
        shape = np.broadcast_shapes(x.shape, y.shape)
        smooth, rough = np.zeros(shape), np.zeros(shape)
        hidden = 0.0
        for index, part in enumerate(self.parts):
            profile = profile_of_part(part, x, y, lattice, f"parts.{index}")
            if part.footprint == "domain":
                rough += profile
                hidden -= float(profile.max())
            else:
                smooth += profile
        total = smooth + rough
        top = float(total.max())
        if not np.isfinite(top):
            raise ConfigError("do not overlap anywhere; shift them so that they do", "parts")
        hidden += self._summit(x, y, smooth, lattice) - float(smooth.max())
        # Rounding may leave the lowest point slightly above 0.
        return np.minimum(total - (top + hidden), 0.0)

    def _summit(self, x: Array, y: Array, smooth: Array, lattice: Lattice | None) -> float:
        """Return the maximum of the sum of the unbounded parts, at cells or between them."""
        from scipy.optimize import minimize

        unbounded = [part for part in self.parts if part.footprint == "unbounded"]

        def heights(px: float, py: float) -> float:
            point = np.array([[px]]), np.array([[py]])
            return float(sum(part.repeated(*point, lattice).item() for part in unbounded))

        # No part is above 0, so a sum of 0 at the centre is the maximum.
        if heights(0.0, 0.0) == 0:
            return 0.0
        i, j = np.unravel_index(np.argmax(smooth), smooth.shape)
        xs, ys = np.broadcast_arrays(x, y)
        start = np.array([xs[i, j], ys[i, j]])
        length, height = np.ptp(xs) + np.ptp(ys), -float(smooth[i, j])
        if height == 0:
            return 0.0
        summit = minimize(
            lambda shift: -heights(*(start + shift * length)) / height,
            np.zeros(2),
            method="Nelder-Mead",
            options={"xatol": 1e-13, "fatol": 1e-15, "initial_simplex": _SIMPLEX},
        )
        if not summit.success:
            raise ConfigError(f"have no lowest point that can be found ({summit.message})", "parts")
        return -float(summit.fun) * height


_SIMPLEX = 0.01 * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
"""Initial simplex of the search for the lowest point, relative to the domain."""
