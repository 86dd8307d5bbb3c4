"""Pyramids, sharp or with a rounded tip."""

from __future__ import annotations

from functools import cache
from math import atan, cos, inf, pi, sin, tan
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import ForceCurve, Indenter
from pellicle.errors import ConfigError
from pellicle.units import Length, Quantity
from pellicle_axisymmetric import Interpolant, cone, contact_part, fill_curve, stretched_spline

SCALE = 0.03
LENGTHS: Array = SCALE * np.expm1(np.arange(0.0, 15.1, 0.5))
"""x = sc/δ of nodes."""
_RATIOS = {
    3: (
        *(0.32649, 0.32747, 0.32856, 0.32896, 0.32739, 0.32119, 0.30661, 0.28183),
        *(0.24952, 0.21584, 0.18541, 0.15993, 0.13930, 0.12278, 0.10946, 0.09874),
        *(0.08984, 0.08249, 0.07626, 0.07090, 0.06630, 0.06195, 0.05859, 0.05555),
        *(0.05275, 0.05021, 0.04791, 0.04582, 0.04391, 0.04215, 0.04054),
    ),
    4: (
        *(0.14724, 0.14785, 0.14854, 0.14899, 0.14845, 0.14558, 0.13876, 0.12734),
        *(0.11274, 0.09764, 0.08407, 0.07277, 0.06363, 0.05631, 0.05041, 0.04560),
        *(0.04162, 0.03829, 0.03547, 0.03304, 0.03094, 0.02910, 0.02747, 0.02602),
        *(0.02472, 0.02355, 0.02249, 0.02152, 0.02064, 0.01983, 0.01908),
    ),
}
"""Logarithm of the force, over that of the cone whose side has the slope of the faces, at nodes
(``docs/reference-data/pyramid_curves.py``)."""


@cache
def _ratio(sides: int) -> Interpolant:
    return stretched_spline(LENGTHS, _RATIOS[sides], SCALE)


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
    half_angle: Annotated[float, Quantity("rad", above=0, below=pi / 2)] = Field(
        title="half-angle",
        description="angle between axis and faces, or edges [rad], or as '70 degree'",
    )
    angle_of: Literal["faces", "edges"] = Field(
        default="faces", description="whether half_angle is that of the faces or of the edges"
    )
    sides: Literal[3, 4] = Field(default=4, description="number of faces")
    tip_radius: Length | None = Field(
        default=None, description="radius of curvature R of a rounded tip [m]"
    )

    accuracy: ClassVar[float] = 3e-4
    """Error of the force curve over the largest force."""

    @property
    def depth_limit(self) -> float:
        """Depth up to which the force curve holds [m]: infinite if it is sharp, else 0."""
        return inf if self.tip_radius is None else 0.0

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return P/E* and its derivatives under a sharp pyramid at depths [m] and s [m].

        By similarity it is that of a cone times a function of sc/δ, from contacts on grids.
        """
        if self.tip_radius is not None:
            raise ConfigError("a rounded pyramid has no known force curve", "indenter")
        touches, d = contact_part(depth)
        by_length = self.slope / d
        x = length * by_length
        ratio, rate = _ratio(self.sides)(x)
        factor, of_cone = np.exp(ratio), cone(atan(1 / self.slope), d, length)
        force = of_cone.force * factor
        return fill_curve(
            touches,
            force,
            of_cone.by_depth * factor - rate * x * force / d,
            of_cone.by_length * factor + rate * by_length * force,
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
