"""The elastic contact that effects act on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from pellicle.arrays import Array
from pellicle.components import HasContactRadius, HasForceCurve
from pellicle.errors import PluginError, shown

Area = Callable[[Array, float], Array]
"""F/E* [m²] at depths [m] and an elastocapillary length s = 2τ₀/E* [m]; 0 at depths ≤ 0."""
_STEP = 1e-4
"""Step of the slope of the force, over the depth."""
_RATIO = 1.1
"""Ratio of the depths to which areas are tabulated."""
_SHALLOW = 1e-6
"""Depth over radius at which any round tip is a paraboloid."""
_NODES = 129
"""Nodes of a tabulated area, evenly spaced in the root of the depth."""


def checked_area(indenter: object, curve: object, depth: Array) -> Array:
    """Return F/E* [m²] of a force curve of an indenter, which may be a stranger's, at depths [m].

    It has to be float64 of their shape (n,), finite at every finite depth.
    """
    area = getattr(curve, "force", None)
    if not (
        isinstance(area, np.ndarray)
        and (area.dtype, area.shape) == (np.float64, depth.shape)
        and np.isfinite(area[np.isfinite(depth)]).all()
    ):
        raise PluginError(
            f"indenter {getattr(indenter, 'type_name', type(indenter).__name__)!r}: its force "
            f"curve is {shown(curve)}; it has to be a ForceCurve whose force is an array of "
            f"float64 of shape {depth.shape}, finite at all depths"
        )
    return area


@dataclass(frozen=True)
class OwnArea:
    """The area of an indenter with its lengths times a factor: λ² A₁(δ/λ, s/λ)."""

    indenter: HasForceCurve
    size: float

    def __call__(self, depth: Array, length: float) -> Array:
        """Return F/E* [m²]."""
        depth, length = depth / self.size, length / self.size
        curve = self.indenter.force_curve(depth, length)
        return self.size**2 * checked_area(self.indenter, curve, depth)


@lru_cache(maxsize=64)
def _spline(area: Area, length: float, deepest: float) -> Callable[[Array], Array]:
    """Return an area at a length as a function of √δ."""
    from scipy.interpolate import CubicSpline

    root = np.linspace(0.0, np.sqrt(deepest), _NODES)
    spline: Callable[[Array], Array] = CubicSpline(root, area(root**2, length))
    return spline


@dataclass(frozen=True)
class Contact:
    """Rigid indenter on an elastic solid under tension: F = E* A(δ, s) with s = 2τ₀/E*.

    That the force over E* is an area that depends on lengths alone follows from dimensional
    analysis.
    """

    indenter: HasForceCurve
    modulus: float
    """E* [Pa]."""
    area: Area
    depth_limit: float
    """Depth [m] beyond which the area is not known, and is continued as a constant."""
    tension: float = 0.0
    """τ₀ [N/m]."""
    size: float = 1.0
    """Factor λ of the indenter's lengths."""
    half_space: bool = True
    """Whether the solid is one, so that half the slope of the area is the contact radius."""
    error: float = 1e-6
    """Error of the area over the largest one."""

    @classmethod
    def on_half_space(cls, indenter: HasForceCurve, modulus: float, size: float = 1.0) -> Contact:
        """Return the contact of an indenter that has a force curve of its own."""
        return cls(
            indenter,
            modulus,
            OwnArea(indenter, size),
            size * indenter.depth_limit,
            size=size,
            half_space=getattr(indenter, "half_space", True),
            error=max(1e-6, getattr(indenter, "accuracy", 0.0)),
        )

    @property
    def tip_radius(self) -> float | None:
        """Radius R of a round tip [m], F = 4/3 E* √R δ^(3/2) where shallow; None of any other."""
        radius = getattr(self.indenter, "radius", None)
        if radius is None:
            return None
        depth = np.array([_SHALLOW * radius])
        hertz = 4 / 3 * _SHALLOW**1.5 * radius**2
        is_round = np.isclose(OwnArea(self.indenter, 1.0)(depth, 0.0)[0], hertz, rtol=0.01, atol=0)
        return self.size * radius if is_round else None

    @property
    def is_own(self) -> bool:
        """Whether it is the indenter itself on a half-space, under a tension or not."""
        return self.half_space and isinstance(self.area, OwnArea)

    @property
    def is_bare_indenter(self) -> bool:
        """Whether it is the indenter itself on a half-space, with a known contact radius."""
        return self.is_own and isinstance(self.indenter, HasContactRadius)

    def force(self, depth: Array) -> Array:
        """Return the force [N] at depths [m]."""
        length = 2 * self.tension / self.modulus
        return self.modulus * self.area(np.minimum(depth, self.depth_limit), length)

    def tabulated(self, deepest: float) -> Contact:
        """Return the contact with its area interpolated up to a depth [m], for many calls.

        Over √δ areas of round and of conical bodies are polynomials, under a tension nearly so.
        """
        length, bare = 2 * self.tension / self.modulus, self.area
        # Rounded up, so that the table serves the next contact point too.
        deepest = _RATIO ** np.ceil(np.log(max(deepest, 1e-60)) / np.log(_RATIO))
        limit = min(float(deepest), self.depth_limit)
        spline = _spline(bare, length, limit)

        def area(depth: Array, other: float) -> Array:
            if other != length:
                return bare(depth, other)
            return np.where(depth > 0, spline(np.sqrt(np.maximum(depth, 0.0))), 0.0)

        return replace(self, area=area, depth_limit=limit)

    def stiffness(self, depth: Array) -> Array:
        """Return ∂F/∂δ [N/m] at depths [m]."""
        step = _STEP * np.maximum(np.abs(depth), 1e-6 * float(np.max(np.abs(depth))))
        return (self.force(depth + step) - self.force(depth - step)) / (2 * step)

    def radius(self, depth: Array) -> Array:
        """Return the contact radius without tension [m], on a half-space: half of ∂(F/E*)/∂δ."""
        return replace(self, tension=0.0).stiffness(depth) / (2 * self.modulus)

    def punch(self, depth: Array) -> tuple[Array, Array, Array, Array]:
        """Return force [N], stiffness k [N/m], radius a [m] and dk/da [Pa] of a bare indenter.

        The stiffness at depths > 0 [m] is that of a flat punch of the radius: 2E*a without tension.
        """
        assert isinstance(self.indenter, HasContactRadius)
        size, length = self.size, 2 * self.tension / self.modulus
        curve = self.indenter.force_curve(depth / size, length / size)
        contact = self.indenter.contact_radius(depth / size, length / size)
        return (
            self.modulus * size**2 * curve.force,
            self.modulus * size * curve.by_depth,
            size * contact.radius,
            self.modulus * contact.stiffness_slope,
        )
