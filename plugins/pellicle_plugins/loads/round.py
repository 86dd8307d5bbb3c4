"""Round loads: a line force on a circle, a pressure on a disc, and both of a sessile drop."""

from __future__ import annotations

from math import asinh, inf, pi, sinh, tan
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from pellicle.arrays import Array
from pellicle.components import Load
from pellicle.errors import ConfigError
from pellicle.units import Length, Quantity

from .shares import edges, within_circle


class Line(Load):
    """Base class of loads with a line force, which is as wide as the cells without a width."""

    width: Annotated[
        Length | None,
        Field(
            title="width of the line", description="width of the line [m]; without, that of a cell"
        ),
    ] = None

    @property
    def has_line_without_width(self) -> bool:
        """Whether there is no width."""
        return self.width is None

    def cells_across(self, dx: float, dy: float) -> float:
        """Return how many cells lie across the width, if there is one."""
        return (self.width or inf) / max(dx, dy)


LineForce = Annotated[
    float,
    Quantity("N/m"),
    Field(title="line force", description="force per length of the line [N/m], > 0 into the solid"),
]


class Ring(Line):
    """Line force on a circle, spread evenly over its width."""

    type: Literal["ring"] = "ring"
    examples = ({"radius": "0.3 mm", "line_force": "-30 mN/m", "width": "10 um"},)
    radius: Annotated[Length, Field(description="radius [m]")]
    line_force: LineForce

    def cells_across(self, dx: float, dy: float) -> float:
        """Return how many cells lie across the diameter or the width, whichever is less."""
        return min(super().cells_across(dx, dy), 2 * self.radius / max(dx, dy))

    def traction(self, x: Array, y: Array) -> Array:
        """Return the traction [Pa] on each cell, 2πR times the line force in sum."""
        return on_circle(x, y, self.radius, self.line_force, self.width)


class Disc(Load):
    """Even pressure on a disc."""

    type: Literal["disc"] = "disc"
    examples = ({"radius": "0.3 mm", "pressure": "100 Pa"},)
    radius: Annotated[Length, Field(description="radius [m]")]
    pressure: Annotated[
        float, Quantity("Pa"), Field(description="pressure on the disc [Pa], > 0 into the solid")
    ]

    def cells_across(self, dx: float, dy: float) -> float:
        """Return how many cells lie across the diameter."""
        return 2 * self.radius / max(dx, dy)

    def traction(self, x: Array, y: Array) -> Array:
        """Return the traction [Pa] on each cell, πR² times the pressure in sum."""
        return self.pressure * within_circle(x, y, self.radius)


class Droplet(Line):
    """Sessile drop: its contact line pulls by γ sin θ, its Laplace pressure pushes as much.

    The pressure within is 2γ sin θ/R, without weight. The tension of the surface counts as equal
    under the drop and beside it.
    """

    type: Literal["droplet"] = "droplet"
    examples = (
        {"surface_tension": "30 mN/m", "contact_angle": "60 degree", "radius": "0.3 mm"},
        {"surface_tension": "72 mN/m", "volume": "0.05 mm3", "radius": "0.3 mm", "width": "9 um"},
    )
    surface_tension: Annotated[
        float,
        Quantity("N/m", above=0),
        Field(title="tension of the liquid", description="surface tension of the liquid γ [N/m]"),
    ]
    contact_angle: Annotated[float, Quantity("rad", above=0, below=pi)] | None = Field(
        None, title="contact angle", description="angle θ between liquid and surface [rad]"
    )
    volume: Annotated[float, Quantity("m3", above=0)] | None = Field(
        None, description="volume [m³], in place of the angle: that of a spherical cap"
    )
    radius: Annotated[Length, Field(description="radius R of the contact line [m]")]

    @model_validator(mode="after")
    def _angle_or_volume(self) -> Self:
        if (self.contact_angle is None) == (self.volume is None):
            raise ConfigError("give exactly one of contact_angle and volume", "contact_angle")
        return self

    def cells_across(self, dx: float, dy: float) -> float:
        """Return how many cells lie across the diameter or the width, whichever is less."""
        return min(super().cells_across(dx, dy), 2 * self.radius / max(dx, dy))

    @property
    def vertical_tension(self) -> float:
        """γ sin θ [N/m]."""
        # The height of the cap over its radius, t, obeys V = πR³ t(3 + t²)/6.
        if self.volume is not None:
            t = 2 * sinh(asinh(3 * self.volume / (pi * self.radius**3)) / 3)
        else:
            t = tan(0.5 * (self.contact_angle or 0.0))
        return self.surface_tension * 2 * t / (1 + t**2)

    def traction(self, x: Array, y: Array) -> Array:
        """Return the traction [Pa] on each cell, whose sum is 0."""
        pull, radius = self.vertical_tension, self.radius
        pressure = 2 * pull / radius * within_circle(x, y, radius)
        return on_circle(x, y, radius, -pull, self.width) + pressure


def on_circle(x: Array, y: Array, radius: float, line_force: float, width: float | None) -> Array:
    """Return the traction [Pa] of a line force [N/m] on a circle, spread over ``width`` [m].

    Without a width it is the longest edge of a cell. The force is 2πR times the line force.
    """
    if width is None:
        width = max(float((high - low).max()) for low, high in (edges(x), edges(y)))
    inner, outer = max(radius - 0.5 * width, 0.0), radius + 0.5 * width
    share = within_circle(x, y, outer)
    if inner > 0:
        share = share - within_circle(x, y, inner)
    traction: Array = 2 * radius * line_force / (outer**2 - inner**2) * share
    return np.asarray(traction)
