"""The contract of indenters."""

from __future__ import annotations

from abc import abstractmethod
from typing import (
    ClassVar,
    Literal,
    NamedTuple,
    Protocol,
    runtime_checkable,
)

from pellicle.arrays import Array

from .base import Component

Footprint = Literal["unbounded", "domain"]


class Indenter(Component):
    """The rigid body that is pressed in.

    One that knows its force on a half-space under tension, as `HasForceCurve` says, is fitted to
    measured curves at once; for any other the force is simulated first.
    """

    family: ClassVar[str] = "indenter"

    @property
    def footprint(self) -> Footprint:
        """``"domain"`` if the indenter ends where the domain does, so that contact may reach there.

        A class whose answer is always the same says ``footprint: ClassVar[Footprint] = "domain"``.
        """
        return "unbounded"

    @abstractmethod
    def profile(self, x: Array, y: Array) -> Array:
        """Return f(x, y) [m]: 0 at the lowest point, negative elsewhere, −inf where there is none.

        ``x`` of shape (nx, 1) and ``y`` of shape (1, ny) are cell centres [m] seen from the centre
        of the domain; the result is of shape (nx, ny). An unbounded indenter that is turned is
        asked for points ``x`` and ``y`` that are both of shape (nx, ny).

        Raises
        ------
        ConfigError
            The indenter cannot be put on these points.
        """


class ForceCurve(NamedTuple):
    """Force over reduced modulus against depth, and its sensitivities, each of shape (n,)."""

    force: Array
    """P/E* [m²]."""
    by_depth: Array
    """∂(P/E*)/∂δ [m]."""
    by_length: Array
    """∂(P/E*)/∂s [m]."""


@runtime_checkable
class HasForceCurve(Protocol):
    """An indenter that knows its force on a half-space under tension; `pellicle.fit` uses it."""

    @property
    def depth_limit(self) -> float:
        """Depth [m] up to which the curve holds; infinite if there is none."""
        ...

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return force and sensitivities; 0 where there is no contact, at ``depth`` ≤ 0.

        Smooth and rising in depth and length.  ``depth`` [m] is of shape (n,), ``length`` ≥ 0 is
        the elastocapillary length s = 2τ₀/E* [m].
        """
        ...


@runtime_checkable
class IsShallowLimit(Protocol):
    """An indenter that stands for another shape as long as it is pressed in little."""

    @property
    def radius(self) -> float:
        """Radius of curvature at the tip [m], against which the depth is little."""
        ...

    def whole_shape(self) -> HasForceCurve:
        """Return the shape that it stands for."""
        ...
