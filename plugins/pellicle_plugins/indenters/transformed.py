"""Another indenter moved, turned or scaled."""

from __future__ import annotations

from math import cos, sin
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from pellicle.arrays import Array
from pellicle.components import Footprint, FromRegistry, Indenter
from pellicle.errors import ConfigError
from pellicle.units import Quantity


class Transformed(Indenter):
    """Base class of the indenters that change one other, their ``part``."""

    part: Annotated[
        Indenter,
        FromRegistry(),
        Field(
            examples=[{"type": "sphere", "radius": "10 um"}],
            description="the indenter to change: a table with type",
        ),
    ]

    moves: ClassVar[bool] = True
    """Whether it moves its part, which must then reach beyond the domain; `Scaled` does not."""

    @property
    def footprint(self) -> Footprint:
        """The footprint of the part."""
        return self.part.footprint

    @model_validator(mode="after")
    def _moved_part_is_unbounded(self) -> Self:
        if self.moves and self.part.footprint == "domain":
            raise ConfigError(
                "ends where the domain does and would leave a part of it empty; move the other "
                "parts of a sum instead, or the heights before they are read",
                "part",
            )
        return self


class Shifted(Transformed):
    """Another indenter moved sideways, off the centre of the domain."""

    type: Literal["shifted"] = "shifted"
    examples = ({"part": {"type": "paraboloid", "radius": "1 mm"}, "x": "0.1 mm", "y": "-0.2 mm"},)
    x: Annotated[
        float, Quantity("m"), Field(title="shift along x", description="shift along x [m]")
    ] = 0.0
    y: Annotated[
        float, Quantity("m"), Field(title="shift along y", description="shift along y [m]")
    ] = 0.0

    def profile(self, x: Array, y: Array) -> Array:
        """Return f(x − x₀, y − y₀) [m]."""
        return profile_of_part(self.part, x - self.x, y - self.y, "part")


class Rotated(Transformed):
    """Another indenter rotated about the vertical through the centre of the domain."""

    type: Literal["rotated"] = "rotated"
    examples = (
        {"part": {"type": "quadric", "radius_x": "1 mm", "radius_y": "2 mm"}, "angle": "30 degree"},
    )
    angle: Annotated[
        float,
        Quantity("rad"),
        Field(description="angle [rad] from x towards y, or as '30 degree'"),
    ]

    def profile(self, x: Array, y: Array) -> Array:
        """Return f(x cos α + y sin α, y cos α − x sin α) [m]."""
        c, s = cos(self.angle), sin(self.angle)
        return profile_of_part(self.part, c * x + s * y, c * y - s * x, "part")


class Scaled(Transformed):
    """Another indenter with its heights multiplied by a factor."""

    type: Literal["scaled"] = "scaled"
    examples = (
        {"part": {"type": "heights", "path": "heights.txt", "unit": "1 um"}, "factor": 0.5},
    )
    moves: ClassVar[bool] = False
    factor: Annotated[
        float,
        Quantity("1", at_least=0),
        Field(
            title="height factor", examples=[0.5], description="factor of the heights; 0 is flat"
        ),
    ]

    def profile(self, x: Array, y: Array) -> Array:
        """Return factor · f [m], or −inf where f is −inf."""
        profile = profile_of_part(self.part, x, y, "part")
        # −inf · 0 would be NaN.
        return np.multiply(profile, self.factor, out=profile.copy(), where=np.isfinite(profile))


def profile_of_part(part: Indenter, x: Array, y: Array, field: str) -> Array:
    """Return the profile [m] of the part in ``field``; its errors name that field."""
    try:
        return part.profile(x, y)
    except ConfigError as error:
        raise error.within(field) from None
