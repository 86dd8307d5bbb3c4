"""The contract of indenters."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar, Literal, NamedTuple, Protocol, runtime_checkable

from pellicle.arrays import Array

from .base import Component

Footprint = Literal["unbounded", "domain"]


class Indenter(Component):
    """The rigid body that is pressed into the surface.

    An indenter with a force curve (`HasForceCurve`) is fitted to measured curves directly; for any
    other the force curve is simulated first.
    """

    family: ClassVar[str] = "indenter"
    place: ClassVar[str] = "indenter"

    @property
    def footprint(self) -> Footprint:
        """``"domain"`` if the indenter ends with the domain, so that contact may reach its edge.

        A class with a constant footprint has ``footprint: ClassVar[Footprint] = "domain"``.
        """
        return "unbounded"

    @abstractmethod
    def profile(self, x: Array, y: Array) -> Array:
        """Return f(x, y) [m]: 0 at the lowest point, negative elsewhere, −inf without an indenter.

        ``x`` of shape (nx, 1) and ``y`` of shape (1, ny) are coordinates of the cell centres [m]
        from the centre of the domain; the result has shape (nx, ny). For an unbounded indenter that
        is rotated, ``x`` and ``y`` both have shape (nx, ny).

        Raises
        ------
        ConfigError
            The indenter has no profile on these points.
        """


class ForceCurve(NamedTuple):
    """Force over reduced modulus at given depths, and its derivatives, each of shape (n,)."""

    force: Array
    """P/E* [m²]."""
    by_depth: Array
    """∂(P/E*)/∂δ [m]."""
    by_length: Array
    """∂(P/E*)/∂s [m]."""


@runtime_checkable
class HasForceCurve(Protocol):
    """An indenter with a known force on a half-space under tension."""

    @property
    def depth_limit(self) -> float:
        """Largest depth [m] at which the curve is valid; infinite if unlimited."""
        ...

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return force and partial derivatives, all 0 at ``depth`` ≤ 0, where there is no contact.

        The force has to be smooth and grow with depth and length. ``depth`` [m] has shape (n,);
        ``length`` ≥ 0 is the elastocapillary length s = 2τ₀/E* [m].
        """
        ...


class ContactRadius(NamedTuple):
    """Contact radius at given depths, and how fast the stiffness grows with it, each shape (n,)."""

    radius: Array
    """a [m]."""
    stiffness_slope: Array
    """dk/da over E*, where k is the stiffness of the flat punch of radius a; 2 without tension."""


@runtime_checkable
class HasContactRadius(Protocol):
    """An indenter of revolution with a known contact radius, from which adhesive ones follow.

    The adhesive contact of radius a is the one without adhesion and a flat punch of the same
    radius, retracted.
    """

    def contact_radius(self, depth: Array, length: float) -> ContactRadius:
        """Return the radius without adhesion at depths > 0 [m], of shape (n,).

        ``length`` ≥ 0 is the elastocapillary length s = 2τ₀/E* [m].
        """
        ...


class LayerForceCurve(NamedTuple):
    """Force over reduced modulus at given depths, and its derivatives, each of shape (n,)."""

    force: Array
    """P/E* [m²]."""
    by_depth: Array
    """∂(P/E*)/∂δ [m]."""
    by_length: Array
    """∂(P/E*)/∂s [m]."""
    by_thickness: Array
    """∂(P/E*)/∂h [m]."""


@runtime_checkable
class HasLayerForceCurve(Protocol):
    """An indenter with a known force on a layer bonded to a rigid base."""

    def layer_depth_limit(self, thickness: float, poissons_ratio: float) -> float:
        """Return the largest depth [m] at which the curve is valid, whatever the tension."""
        ...

    def layer_force_curve(
        self, depth: Array, length: float, thickness: float, poissons_ratio: float
    ) -> LayerForceCurve:
        """Return force and partial derivatives, all 0 at ``depth`` ≤ 0, where there is no contact.

        ``depth`` [m] has shape (n,); ``length`` ≥ 0 is the elastocapillary length s = 2τ₀/E* [m],
        ``thickness`` > 0 that of the layer, h [m]; 0 ≤ ``poissons_ratio`` ≤ ½.
        """
        ...


@runtime_checkable
class IsShallowLimit(Protocol):
    """An indenter that approximates another shape at small depths."""

    @property
    def radius(self) -> float:
        """Radius of curvature at the tip [m]; the depth must be small compared with it."""
        ...

    def whole_shape(self) -> HasForceCurve:
        """Return the shape that it approximates."""
        ...
