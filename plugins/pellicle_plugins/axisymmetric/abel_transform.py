"""Rigid axisymmetric indenters, described by the Abel transform of their profile."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Protocol, runtime_checkable

from pellicle.arrays import Array


@runtime_checkable
class HasAbelTransform(Hashable, Protocol):
    """A smooth-edged indenter of revolution; optional for an indenter component.

    For a profile f(r) ≤ 0 [m], 0 at the apex, the transform is

        h(x) = −x ∫₀^x f'(r) / sqrt(x² − r²) dr   [m].

    Without tension the depth is h(a) and the force 2 E* (a h(a) − ∫₀^a h dx) at contact radius a
    (Sneddon 1965). An indenter with this transform has a reference solution under tension too.
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
