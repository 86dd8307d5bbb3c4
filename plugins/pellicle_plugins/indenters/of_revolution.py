"""Indenters of revolution, whose force curves are interpolated between exact solutions."""

from __future__ import annotations

from math import inf, pi, sqrt, tan
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from pellicle.arrays import Array
from pellicle.components import ContactRadius, ForceCurve, Indenter, LayerForceCurve
from pellicle.errors import ConfigError, excerpt
from pellicle.units import Length, Quantity
from pellicle_axisymmetric import (
    BodyOfRevolution,
    Profile,
    Punch,
    TensedLayer,
    cone,
    cone_profile,
    flat_punch,
    paraboloid,
    punch_radius,
    smooth_profile,
    stretch_curve,
)

_TINY = 1e-12
"""Height of a tip that is lost, over the depth, below which no force shows it."""


def _root(x: Array, edge: float) -> Array:
    """Return √(x² − b²) [m] at positions beyond an edge of radius b [m], 0 within it."""
    # The difference of squares would cancel beside the edge.
    return np.asarray(np.sqrt(np.maximum(x - edge, 0.0)) * np.sqrt(x + edge))


class Sphere(BodyOfRevolution):
    """Sphere with its exact profile up to its equator, or with a tip that is worn flat."""

    type: Literal["sphere"] = "sphere"
    examples = ({"radius": "0.4 mm"}, {"radius": "0.4 mm", "flat_radius": "0.05 mm"})
    radius: Length = Field(description="radius R [m]")
    flat_radius: Length | None = Field(default=None, description="radius b of a worn tip [m]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.flat_radius is not None and not self.flat_radius < self.radius:
            raise ConfigError(
                f"has to be less than the radius, {excerpt(self.radius)} m", "flat_radius"
            )
        return self

    def profile(self, x: Array, y: Array) -> Array:
        """Return √(R² − x² − y²) − √(R² − b²) [m], at most 0, −inf beyond the equator."""
        distance, flat = np.hypot(x, y), self.flat_radius or 0.0
        inside = distance <= self.radius
        # R² − r² as a product does not overflow.
        root = np.sqrt(self.radius - distance, where=inside, out=np.zeros_like(distance))
        root *= np.sqrt(self.radius + distance)
        # The difference of the roots would cancel near the tip.
        beyond = np.maximum(distance - flat, 0.0) * ((distance + flat) / self.radius)
        shape = -beyond / (self._height + root / self.radius)
        return np.where(inside, shape, -np.inf)

    @property
    def _height(self) -> float:
        """Distance of the flat from the centre over R."""
        share = (self.flat_radius or 0.0) / self.radius
        return sqrt((1 - share) * (1 + share))

    @property
    def kinks(self) -> tuple[float, ...]:
        """Radius of the flat [m]."""
        return () if self.flat_radius is None else (self.flat_radius,)

    @property
    def depth_limit(self) -> float:
        """Depth R at which the equator is reached [m]; less of a worn tip."""
        return self.radius * self._height

    @property
    def contact_radius_limit(self) -> float:
        """R [m]: no contact is wider than the equator."""
        return self.radius

    def abel_transform(self, x: Array) -> Array:
        """Return h(x) = x artanh √((x² − b²)/(R² − b²)) [m]; see `HasAbelSlope`."""
        return np.asarray(x * np.arctanh(self._share(x)))

    def abel_slope(self, x: Array) -> Array:
        """Return h'(x) for contact radii x [m]."""
        u, share = x / self.radius, self._share(x)
        rate = np.divide(u**2, share, out=np.zeros_like(u), where=share > 0)
        return np.arctanh(share) + rate / ((1 - u) * (1 + u))

    def _share(self, x: Array) -> Array:
        return _root(x, self.flat_radius or 0.0) / self.radius / self._height

    def _layer_curves(self) -> Profile | None:
        smooth = self.flat_radius is None
        return smooth_profile(self.radius, self.radius, self.abel_slope) if smooth else None


class Paraboloid(BodyOfRevolution):
    """Paraboloid of revolution, as in the theory of Hertz, or with a tip that is worn flat.

    It is the shallow limit of a sphere.
    """

    type: Literal["paraboloid"] = "paraboloid"
    examples = ({"radius": "1 mm"}, {"radius": "1 mm", "flat_radius": "0.1 mm"})
    radius: Length = Field(description="radius of curvature R at the tip [m]")
    flat_radius: Length | None = Field(default=None, description="radius b of a worn tip [m]")

    def profile(self, x: Array, y: Array) -> Array:
        """Return −(r² − b²)/2R [m], and 0 up to the radius of the flat."""
        # 2R of the largest double would be infinite and the paraboloid flat.
        if self.flat_radius is None:
            return -(x**2 + y**2) / 2 / self.radius
        distance = np.hypot(x, y)
        beyond = np.maximum(distance - self.flat_radius, 0.0)
        return np.asarray(-beyond * (distance + self.flat_radius) / 2 / self.radius)

    @property
    def kinks(self) -> tuple[float, ...]:
        """Radius of the flat [m]."""
        return () if self.flat_radius is None else (self.flat_radius,)

    def abel_transform(self, x: Array) -> Array:
        """Return h(x) = (x/R) √(x² − b²) [m] for contact radii x [m]; see `HasAbelSlope`."""
        return x * _root(x, self.flat_radius or 0.0) / self.radius

    def abel_slope(self, x: Array) -> Array:
        """Return h'(x) for contact radii x [m]."""
        root = _root(x, self.flat_radius or 0.0)
        rate = np.divide(x**2, root, out=np.zeros_like(x), where=root > 0)
        return (root + rate) / self.radius

    def _half_space_curve(self, depth: Array, length: float) -> ForceCurve:
        flat = self.flat_radius or 0.0
        height = flat * (flat / self.radius)
        if height <= _TINY * depth.max(initial=0.0):
            return paraboloid(self.radius, depth, length)
        return stretch_curve(_WORN, flat, height, depth, length)

    def _layer_curves(self) -> Profile | None:
        smooth = self.flat_radius is None
        return smooth_profile(self.radius, inf, self.abel_slope) if smooth else None


class Cone(BodyOfRevolution):
    """Cone with its tip down, sharp or blunted by a paraboloid that goes over into it smoothly."""

    type: Literal["cone"] = "cone"
    examples = ({"half_angle": "70 degree"}, {"half_angle": "20 degree", "tip_radius": "20 nm"})
    half_angle: Annotated[float, Quantity("rad", above=0, below=pi / 2)] = Field(
        title="half-angle", description="angle between axis and side [rad], or as '70 degree'"
    )
    tip_radius: Length | None = Field(
        default=None, description="radius of curvature R of a blunt tip [m]"
    )

    def profile(self, x: Array, y: Array) -> Array:
        """Return −r cot α [m]; of a blunted cone −r²/2R up to b, and −(r − b/2) cot α beyond."""
        distance, end = np.hypot(x, y), self._blunt
        inside = np.minimum(distance, end)
        shape = (distance - inside) / tan(self.half_angle)
        return -shape if self.tip_radius is None else -shape - inside**2 / 2 / self.tip_radius

    @property
    def _blunt(self) -> float:
        """Radius b = R cot α [m] at which the tip goes over into the cone; 0 if it is sharp."""
        return (self.tip_radius or 0.0) / tan(self.half_angle)

    @property
    def pointed(self) -> bool:
        """Whether the tip is sharp."""
        return self.tip_radius is None

    @property
    def kinks(self) -> tuple[float, ...]:
        """Radius at which the tip goes over into the cone [m]."""
        return () if self.tip_radius is None else (self._blunt,)

    def abel_transform(self, x: Array) -> Array:
        """Return h(x) [m] for contact radii x [m] (Briscoe, Sebastian & Adams 1994).

        It is (π/2) x cot α of a sharp cone, x²/R up to b of a blunted one, and beyond
        x [(x − √(x² − b²))/R + arccos(b/x) cot α].
        """
        return np.asarray(x * self._parts(x, 1.0))

    def abel_slope(self, x: Array) -> Array:
        """Return h'(x) for contact radii x [m]."""
        return self._parts(x, 2.0)

    def _parts(self, x: Array, times: float) -> Array:
        """Return what the cone and, ``times`` a factor, what the tip adds to h/x."""
        if self.tip_radius is None:
            return np.full_like(x, pi / 2 / tan(self.half_angle))
        beyond = np.maximum(x, self._blunt)
        tip = (x - _root(x, self._blunt)) / self.tip_radius
        return np.asarray(times * tip + np.arccos(self._blunt / beyond) / tan(self.half_angle))

    def _half_space_curve(self, depth: Array, length: float) -> ForceCurve:
        height = self._blunt / tan(self.half_angle)
        if height <= _TINY * depth.max(initial=0.0):
            return cone(self.half_angle, depth, length)
        return stretch_curve(_BLUNT, self._blunt, height, depth, length)

    def _layer_curves(self) -> Profile | None:
        return cone_profile(self.half_angle) if self.tip_radius is None else None


_WORN = Paraboloid(radius=1.0, flat_radius=1.0)
_BLUNT = Cone(half_angle=pi / 4, tip_radius=1.0)
"""Bodies of which all worn paraboloids and all blunted cones are stretched copies."""


class FlatPunch(Indenter):
    """Flat-ended circular cylinder of the cells whose centres lie under it."""

    type: Literal["flat_punch"] = "flat_punch"
    examples = ({"radius": "0.3 mm"},)
    radius: Length = Field(description="radius of the flat end [m]")

    def profile(self, x: Array, y: Array) -> Array:
        """Return 0 under the punch and −inf beside it [m]."""
        return np.where(x**2 + y**2 <= self.radius**2, 0.0, -np.inf)

    depth_limit: ClassVar[float] = inf

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return P/E* and its partial derivatives at depths [m] and s = 2τ₀/E* [m]."""
        return flat_punch(self.radius, depth, length)

    def contact_radius(self, depth: Array, length: float) -> ContactRadius:
        """Return the radius at depths > 0 [m], and dk/da over E*."""
        return punch_radius(self.force_curve(depth, length).by_depth, length)

    def layer_depth_limit(self, thickness: float, poissons_ratio: float) -> float:
        """Return the depth [m] up to which the force curve holds on a bonded layer."""
        return Punch(self.radius).depth_limit(thickness, poissons_ratio)

    def layer_force_curve(
        self, depth: Array, length: float, thickness: float, poissons_ratio: float
    ) -> LayerForceCurve:
        """Return P/E* and its partial derivatives on a bonded layer, 0 ≤ ν ≤ ½."""
        return Punch(self.radius).curve(depth, TensedLayer(length, thickness, poissons_ratio))
