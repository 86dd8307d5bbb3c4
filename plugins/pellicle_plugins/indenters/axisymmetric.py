"""Indenters of revolution whose force curve is interpolated from master curves."""

from __future__ import annotations

from abc import abstractmethod

from pellicle.arrays import Array
from pellicle.components import ForceCurve, Indenter


class Axisymmetric(Indenter):
    """An indenter of revolution with a master curve of the axisymmetric equation."""

    @property
    def depth_limit(self) -> float:
        """Depth [m] up to which the force curve holds; infinite unless the shape ends."""
        return float("inf")

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return P/E* and its partial derivatives at depths [m] and s = 2τ₀/E* [m]."""
        return self._master_curve(depth, length)

    @abstractmethod
    def _master_curve(self, depth: Array, length: float) -> ForceCurve: ...
