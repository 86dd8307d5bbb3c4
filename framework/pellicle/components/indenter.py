"""The contract of indenters."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar, Literal, NamedTuple, Protocol, runtime_checkable

from pellicle.arrays import Array

from .base import Component

Footprint = Literal["unbounded", "domain"]


class Indenter(Component):
    """The rigid body that is pressed into the surface.

    An indenter with the force curve of `HasForceCurve` is fitted to measured curves directly; for
    any other the force curve is simulated first.
    """

    family: ClassVar[str] = "indenter"

    @property
    def footprint(self) -> Footprint:
        """``"domain"`` if the indenter ends with the domain, so that contact may reach its edge.

        A class with a constant footprint has ``footprint: ClassVar[Footprint] = "domain"``.
        """
        return "unbounded"

    @abstractmethod
    def profile(self, x: Array, y: Array) -> Array:
        """Return f(x, y) [m]: 0 at the lowest point, negative elsewhere, −inf without an indenter.

        ``x`` of shape (nx, 1) and ``y`` of shape (1, ny) are cell centres [m], seen from the centre
        of the domain; the result is of shape (nx, ny). An unbounded indenter that is rotated gets
        ``x`` and ``y`` that are both of shape (nx, ny).

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
    """An indenter with a known force on a half-space under tension, for `pellicle.fit`."""

    @property
    def depth_limit(self) -> float:
        """Depth [m] up to which the curve holds; infinite if there is none."""
        ...

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return force and partial derivatives; 0 without contact, at ``depth`` ≤ 0.

        The force is smooth and grows with depth and length. ``depth`` [m] is of shape (n,),
        ``length`` ≥ 0 is the elastocapillary length s = 2τ₀/E* [m].
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
