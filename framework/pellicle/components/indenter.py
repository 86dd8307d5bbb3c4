"""The contract of indenters."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Hashable
from typing import ClassVar, Literal, NamedTuple, Protocol, runtime_checkable

from pellicle.arrays import Array
from pellicle.plugins.component import Component

from .lattice import Lattice

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
        is rotated, ``x`` and ``y`` both have shape (nx, ny). An indenter that has no profile on
        these points raises a ConfigError.
        """

    def repeated(self, x: Array, y: Array, lattice: Lattice | None) -> Array:
        """Return the profile [m] of the indenter and its images at points as for `profile`.

        On a periodic grid, whose ``lattice`` is given, all images press, and the lowest at a point
        counts: neither the place of an indenter nor the origin of the grid then matters. An
        indenter made of others overrides it and asks its parts. ``lattice`` is None on a free grid.
        """
        if lattice is None:
            return self.profile(x, y)
        known_at_cells = self.footprint == "domain"
        return (lattice.roll if known_at_cells else lattice.envelope)(self.profile, x, y)


@runtime_checkable
class HasAbelSlope(Hashable, Protocol):
    """A smooth-edged indenter of revolution; optional for an indenter component.

    For a profile f(r) ≤ 0 [m], 0 at the apex, the transform is

        h(x) = −x ∫₀^x f'(r) / sqrt(x² − r²) dr   [m].

    Without tension the depth is h(a) and the force 2 E* (a h(a) − ∫₀^a h dx) at contact radius a
    (Sneddon 1965). An indenter with this transform has a reference solution under tension too.

    If slope or curvature of the profile jumps, ``kinks`` are the radii [m] where, in order, and
    ``abel_transform(x)`` returns h(x) [m]; of other profiles h is integrated.
    """

    @property
    def contact_radius_limit(self) -> float:
        """Upper bound of the contact radius, never attained [m]; infinite if there is none."""
        ...

    @property
    def pointed(self) -> bool:
        """Whether the profile has a corner at its apex."""
        ...

    def abel_slope(self, x: Array) -> Array:
        """Return h'(x), dimensionless, at positions 0 ≤ x < `contact_radius_limit` [m]."""
        ...


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
        """Largest depth [m] at which the curve holds: infinite if at any, 0 if at none."""
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
