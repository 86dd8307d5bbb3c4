"""The elastic contact that effects act on."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, Protocol, cast, runtime_checkable

import numpy as np

from pellicle.arrays import Array
from pellicle.components import HasContactRadius, HasForceCurve
from pellicle_axisymmetric import punch_radius

from .area_table import Areas, half_space

Area = Callable[[Array, float], Array]
"""F/E* [m²] at depths [m] and an elastocapillary length s = 2τ₀/E* [m]; 0 at depths ≤ 0."""
_STEP = 1e-4
"""Step of the slope of the force, over the depth."""
_SHALLOW = 1e-6
"""Depth over radius at which any round tip is a paraboloid."""
_LEAST = 1e-9
"""Least s that adhesion sees, over the greatest depth."""


@dataclass(frozen=True)
class OwnArea:
    """The area of an indenter that is stretched by λ, and by η in height: λη A₁(δ/η, s/λ)."""

    areas: Areas
    """Those of the indenter itself."""
    width: float
    """λ."""
    height: float
    """η."""

    def __call__(self, depth: Array, length: float) -> Array:
        """Return F/E* [m²]."""
        if isinstance(self.width, float) and self.width == self.height == 1.0:
            return self.areas(depth, length)
        area = self.areas(depth / self.height, length / self.width)
        return self.width * self.height * area

    def slopes(self, depth: Array, length: float) -> tuple[Array, Array]:
        """Return F/E* [m²] and its derivative by the depth [m]."""
        area, slope = self.areas.slopes(depth / self.height, length / self.width)
        return self.width * self.height * area, self.width * slope


@runtime_checkable
class HasModulus(Protocol):
    """A body that yields too, so that F/E* depends on the modulus of the solid."""

    modulus: float

    def area(self, deepest: float, size: float, modulus: float) -> Area:
        """Return F/E* [m²] on a solid of a modulus [Pa], down to a depth [m]."""


@lru_cache(maxsize=64)
def _own_radius(indenter: Any) -> float:
    radius = float(getattr(indenter, "radius", 0.0))
    if not radius:
        return 0.0
    area = indenter.force_curve(np.array([_SHALLOW * radius]), 0.0).force[0]
    hertz = 4 / 3 * _SHALLOW**1.5 * radius**2
    return radius if np.isclose(area, hertz, rtol=0.01, atol=0) else 0.0


def _area(indenter: HasForceCurve, deepest: float, size: float, modulus: float) -> Area:
    if isinstance(indenter, HasModulus):
        return indenter.area(deepest, size, modulus)
    reach = min(deepest, indenter.depth_limit)
    return OwnArea(half_space(cast("Hashable", indenter), reach), size, size)


@dataclass(frozen=True)
class Contact:
    """Rigid indenter on an elastic solid under tension: F = E* A(δ, s) with s = 2τ₀/E*.

    Modulus, tension and size are numbers, or columns of shape (k, 1) of k trials; depths have shape
    (n,) or (k, n).

    That the force over E* is an area that depends on lengths alone follows from dimensional
    analysis.
    """

    indenter: HasForceCurve
    modulus: float
    """E* [Pa]."""
    area: Area
    depth_limit: float
    """Depth [m] beyond which the area is not known, and is continued as a constant."""
    deepest: float
    """Depth [m] that no search exceeds."""
    tension: float = 0.0
    """τ₀ [N/m]."""
    size: float = 1.0
    """Factor λ of the indenter's lengths."""
    half_space: bool = True
    """Whether the solid is one, so that half the slope of the area is the contact radius."""
    error: float = 1e-6
    """Error of the area over the largest one."""

    @classmethod
    def on_half_space(
        cls, indenter: HasForceCurve, modulus: float, deepest: float, size: float = 1.0
    ) -> Contact:
        """Return the contact of an indenter that has a force curve of its own.

        Areas are tabulated down to a depth [m], rounded up to one of three in a decade, so that
        curves share tables.
        """
        deepest = float(10 ** (np.ceil(3 * np.log10(max(deepest, 1e-60))) / 3))
        return cls(
            indenter,
            modulus,
            _area(indenter, deepest, size, modulus),
            size * indenter.depth_limit,
            deepest,
            size=size,
            half_space=getattr(indenter, "half_space", True),
            error=max(1e-6, getattr(indenter, "accuracy", 0.0)),
        )

    def of_modulus(self, modulus: float) -> Contact:
        """Return the same contact with a solid of another modulus [Pa]."""
        if self.half_space or not isinstance(self.indenter, HasModulus):
            return replace(self, modulus=modulus)
        area = self.indenter.area(self.deepest, self.size, modulus)
        return replace(self, modulus=modulus, area=area)

    @cached_property
    def length(self) -> float:
        """Elastocapillary length s = 2τ₀/E* [m]."""
        return 2 * self.tension / self.modulus

    @property
    def own_radius(self) -> float:
        """Radius of a round tip of size 1 [m], 0 of any other."""
        return _own_radius(cast("Hashable", self.indenter))

    @property
    def tip_radius(self) -> float | None:
        """Radius R of a round tip [m], F = 4/3 E* √R δ^(3/2) where shallow; None of any other."""
        return self.size * self.own_radius if self.own_radius else None

    @property
    def is_bare(self) -> bool:
        """Whether it is the indenter itself on a half-space, under a tension or not."""
        return self.half_space and isinstance(self.area, OwnArea)

    @property
    def is_bare_indenter(self) -> bool:
        """Whether it is the indenter itself on a half-space, with a known contact radius."""
        return self.is_bare and isinstance(self.indenter, HasContactRadius)

    def force(self, depth: Array) -> Array:
        """Return the force [N] at depths [m]."""
        area = self.area(np.minimum(depth, self.depth_limit), self.length)
        return np.asarray(self.modulus * area)

    def stiffness(self, depth: Array) -> Array:
        """Return ∂F/∂δ [N/m] at depths [m]."""
        deep = np.abs(depth)
        step = _STEP * np.maximum(deep, 1e-6 * np.max(deep, axis=-1, keepdims=True))
        return np.asarray((self.force(depth + step) - self.force(depth - step)) / (2 * step))

    def radius(self, depth: Array) -> Array:
        """Return the contact radius without tension [m], on a half-space: half of ∂(F/E*)/∂δ."""
        return np.asarray(replace(self, tension=0.0).stiffness(depth) / (2 * self.modulus))

    def punch(self, depth: Array) -> tuple[Array, Array, Array, Array]:
        """Return force [N], stiffness k [N/m], radius a [m] and dk/da [Pa] of a bare indenter.

        The stiffness at depths > 0 [m] is that of a flat punch of the radius: 2E*a without tension.
        """
        assert isinstance(self.area, OwnArea)
        area, by_depth = self.area.slopes(depth, self.length)
        if np.any(self.length):
            lengths = np.broadcast_to(np.maximum(self.length, _LEAST * self.deepest), depth.shape)
            solution = punch_radius(by_depth.ravel(), lengths.ravel())
            radius, slope = (part.reshape(depth.shape) for part in solution)
        else:
            radius, slope = by_depth / 2, np.full_like(by_depth, 2.0)
        return self.modulus * area, self.modulus * by_depth, radius, self.modulus * slope
