"""Indenters of revolution whose force curve is interpolated from master curves."""

from __future__ import annotations

from abc import abstractmethod

from pellicle.arrays import Array
from pellicle.components import ContactRadius, ForceCurve, Indenter
from pellicle_plugins.analytic.master_curves import punch_radius


class Axisymmetric(Indenter):
    """An indenter of revolution with a master curve of the axisymmetric equation."""

    @property
    def depth_limit(self) -> float:
        """Depth [m] up to which the force curve holds; infinite unless the shape ends."""
        return float("inf")

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return P/E* and its partial derivatives at depths [m] and s = 2τ₀/E* [m]."""
        return self._master_curve(depth, length)

    def contact_radius(self, depth: Array, length: float) -> ContactRadius:
        """Return the contact radius without adhesion at depths > 0 [m], and dk/da over E*.

        The stiffness dF/dδ is that of the flat punch of the same radius.
        """
        return punch_radius(self._master_curve(depth, length).by_depth, length)

    @abstractmethod
    def _master_curve(self, depth: Array, length: float) -> ForceCurve: ...
