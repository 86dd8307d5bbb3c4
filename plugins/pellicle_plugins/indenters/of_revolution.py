"""Indenters of revolution whose force curves are interpolated between exact solutions."""

from __future__ import annotations

from abc import abstractmethod
from functools import lru_cache

import numpy as np

from pellicle.arrays import Array
from pellicle.components import ContactRadius, ForceCurve, Indenter, LayerForceCurve
from pellicle_plugins.axisymmetric.layer_curves import Profile, Punch, TensedLayer
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
    def _make_layer_curves(self) -> Profile | Punch:
        """Return the curves of the indenter on bonded layers."""


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
