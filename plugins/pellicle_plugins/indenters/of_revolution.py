"""Indenters of revolution, whose force curves are interpolated between exact solutions."""

from __future__ import annotations

from abc import abstractmethod
from functools import lru_cache
from math import inf, pi, tan
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import ContactRadius, ForceCurve, Indenter, LayerForceCurve
from pellicle.units import Length, Quantity
from pellicle_plugins.axisymmetric import master_curves
from pellicle_plugins.axisymmetric.layer_curves import (
    Profile,
    Punch,
    TensedLayer,
    cone_profile,
    smooth_profile,
)
from pellicle_plugins.axisymmetric.master_curves import punch_radius


class Axisymmetric(Indenter):
    """An indenter of revolution with curves of the axisymmetric equation."""

    @property
    def depth_limit(self) -> float:
        """Depth [m] up to which the force curve holds; infinite unless the shape ends."""
        return float("inf")

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return P/E* and its partial derivatives at depths [m] and s = 2τ₀/E* [m]."""
        return ForceCurve(*(part.copy() for part in self._curve(depth, length)))

    def contact_radius(self, depth: Array, length: float) -> ContactRadius:
        """Return the contact radius without adhesion at depths > 0 [m], and dk/da over E*.

        The stiffness dF/dδ is that of the flat punch of the same radius.
        """
        return punch_radius(self._curve(depth, length).by_depth, length)

    def layer_depth_limit(self, thickness: float, poissons_ratio: float) -> float:
        """Return the depth [m] up to which the force curve holds on a bonded layer."""
        limit = _layer_curves(self).depth_limit(thickness, poissons_ratio)
        return min(limit, self.depth_limit)

    def layer_force_curve(
        self, depth: Array, length: float, thickness: float, poissons_ratio: float
    ) -> LayerForceCurve:
        """Return P/E* and its partial derivatives on a bonded layer, 0 ≤ ν ≤ ½."""
        layer = TensedLayer(length, thickness, poissons_ratio)
        return _layer_curves(self).curve(depth, layer)

    def _curve(self, depth: Array, length: float) -> ForceCurve:
        """Return the force curve at depths of shape (n,), in arrays that calls share."""
        depth = np.asarray(depth, dtype=float)
        return _kept_curve(self, depth.tobytes(), depth.shape, length)

    @abstractmethod
    def _master_curve(self, depth: Array, length: float) -> ForceCurve: ...

    @abstractmethod
    def _make_layer_curves(self) -> Profile | Punch: ...


# A fit with adhesion asks for the force curve and the contact radius at the same depths.
@lru_cache(maxsize=1)
def _kept_curve(
    indenter: Axisymmetric, depth: bytes, shape: tuple[int, ...], length: float
) -> ForceCurve:
    return indenter._master_curve(np.frombuffer(depth).reshape(shape), length)


@lru_cache(maxsize=64)
def _layer_curves(indenter: Axisymmetric) -> Profile | Punch:
    # Splines are kept for each profile, which has to be the same object for equal indenters.
    return indenter._make_layer_curves()


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


class Cone(Axisymmetric):
    """Cone with its tip down."""

    type: Literal["cone"] = "cone"
    examples = ({"half_angle": "70 degree"},)
    half_angle: Annotated[
        float,
        Quantity("rad", above=0, below=pi / 2),
        Field(
            title="half-angle", description="angle between axis and side [rad], or as '70 degree'"
        ),
    ]

    def profile(self, x: Array, y: Array) -> Array:
        """Return −r cot α [m]."""
        return -np.hypot(x, y) / tan(self.half_angle)

    contact_radius_limit: ClassVar[float] = inf
    pointed: ClassVar[bool] = True

    def abel_slope(self, x: Array) -> Array:
        """Return h' = (π/2) cot α for contact radii x [m]; see `HasAbelTransform`."""
        return np.full_like(x, pi / 2 / tan(self.half_angle))

    def _master_curve(self, depth: Array, length: float) -> ForceCurve:
        return master_curves.cone(self.half_angle, depth, length)

    def _make_layer_curves(self) -> Profile:
        return cone_profile(self.half_angle)


class FlatPunch(Axisymmetric):
    """Flat-ended circular cylinder of the cells whose centres lie under it."""

    type: Literal["flat_punch"] = "flat_punch"
    examples = ({"radius": "0.3 mm"},)
    radius: Annotated[Length, Field(description="radius of the flat end [m]")]

    def profile(self, x: Array, y: Array) -> Array:
        """Return 0 under the punch and −inf beside it [m]."""
        return np.where(x**2 + y**2 <= self.radius**2, 0.0, -np.inf)

    def _master_curve(self, depth: Array, length: float) -> ForceCurve:
        return master_curves.flat_punch(self.radius, depth, length)

    def _make_layer_curves(self) -> Punch:
        return Punch(self.radius)
