"""Pyramids, sharp or with a rounded tip."""

from __future__ import annotations

from math import cos, pi, sin, tan
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import Indenter
from pellicle.units import Length, Quantity


class Pyramid(Indenter):
    """Regular pyramid with its tip down, one face towards x, sharp or rounded.

    With the normals nₖ of its faces in the plane and their slope c, the profile of a sharp one is
    −c max nₖ·x.  A rounded one is what a paraboloid of the radius R of the tip can reach from
    inside, −max (c w·x − R c²w²/2) over w in the polygon of the normals (Moreau 1965): round up to
    r = R c at its narrowest, with edges as round.
    """

    type: Literal["pyramid"] = "pyramid"
    examples = (
        {"half_angle": "70 degree"},
        {"half_angle": "75 degree", "angle_of": "edges", "sides": 3, "tip_radius": "20 nm"},
    )
    half_angle: Annotated[
        float,
        Quantity("rad", above=0, below=pi / 2),
        Field(
            title="half-angle",
            description="angle between axis and faces, or edges [rad], or as '70 degree'",
        ),
    ]
    angle_of: Literal["faces", "edges"] = Field(
        default="faces", description="whether half_angle is that of the faces or of the edges"
    )
    sides: Literal[3, 4] = Field(default=4, description="number of faces")
    tip_radius: Length | None = Field(
        default=None, description="radius of curvature R of a rounded tip [m]"
    )

    @property
    def slope(self) -> float:
        """Slope c of the faces; along an edge it is less by cos π/n."""
        steeper = cos(pi / self.sides) if self.angle_of == "edges" else 1.0
        return 1 / tan(self.half_angle) / steeper

    def profile(self, x: Array, y: Array) -> Array:
        """Return the largest profile of the faces, or of what rounds them [m], at most 0."""
        part = pi / self.sides
        # By symmetry all lies between a normal and the edge beside it.
        azimuth = np.abs((np.arctan2(y, x) + part) % (2 * part) - part)
        radius = np.hypot(x, y)
        if self.tip_radius is None:
            return np.asarray(-self.slope * radius * np.cos(azimuth))
        round_ = self.tip_radius * self.slope
        along, across = radius * np.cos(azimuth - part), radius * np.sin(azimuth - part)
        # w is the point of the polygon that is next to x/Rc; its corners are the normals.
        side, corner = (
            np.minimum(along / round_, cos(part)),
            np.maximum(across / round_, -sin(part)),
        )
        lift = side * along + corner * across
        return np.asarray(-self.slope * (lift - round_ / 2 * (side**2 + corner**2)))
