"""The base class of indenters of revolution, whose force under tension is known without a grid."""

from __future__ import annotations

from abc import abstractmethod
from functools import lru_cache
from math import inf

import numpy as np

from pellicle.arrays import Array
from pellicle.components import ContactRadius, ForceCurve, Indenter, LayerForceCurve
from pellicle.errors import ConfigError

from .depth_curves import force_curve
from .layer_curves import Profile, TensedLayer
from .master_curves import punch_radius


class BodyOfRevolution(Indenter):
    """Indenter of revolution: `abel_slope` gives what fits, figures and adhesion ask of it.

    With edges it has `kinks` and `abel_transform` as well, see `HasAbelSlope`. A body that ends
    has a `contact_radius_limit` and a `depth_limit`.
    """

    @property
    def depth_limit(self) -> float:
        """Depth [m] up to which the force curve holds; infinite unless the shape ends."""
        return inf

    @property
    def contact_radius_limit(self) -> float:
        """Upper bound of the contact radius, never attained [m]; infinite if there is none."""
        return inf

    @property
    def pointed(self) -> bool:
        """Whether the profile has a corner at its apex."""
        return False

    @property
    def kinks(self) -> tuple[float, ...]:
        """Radii [m], in order, at which slope or curvature of the profile jumps."""
        return ()

    @abstractmethod
    def abel_slope(self, x: Array) -> Array:
        """Return h'(x), dimensionless, at positions 0 ≤ x < `contact_radius_limit` [m]."""

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return P/E* and its partial derivatives at depths [m] and s = 2τ₀/E* [m]."""
        return ForceCurve(*(part.copy() for part in self._shared_curve(depth, length)))

    def contact_radius(self, depth: Array, length: float) -> ContactRadius:
        """Return the contact radius without adhesion at depths > 0 [m], and dk/da over E*.

        The stiffness dF/dδ is that of the flat punch of the same radius.
        """
        return punch_radius(self._shared_curve(depth, length).by_depth, length)

    def layer_depth_limit(self, thickness: float, poissons_ratio: float) -> float:
        """Return the depth [m] up to which the force curve holds on a bonded layer; 0 if none."""
        curves = _kept_layer_curves(self)
        limit = curves.depth_limit(thickness, poissons_ratio) if curves else 0.0
        return min(limit, self.depth_limit)

    def layer_force_curve(
        self, depth: Array, length: float, thickness: float, poissons_ratio: float
    ) -> LayerForceCurve:
        """Return P/E* and its partial derivatives on a bonded layer, 0 ≤ ν ≤ ½."""
        curves = _kept_layer_curves(self)
        if curves is None:
            raise ConfigError(f"{self.type_name} has no known force curve on a layer", "indenter")
        return curves.curve(depth, TensedLayer(length, thickness, poissons_ratio))

    def _shared_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return the force curve at depths of shape (n,), in arrays that calls share."""
        depth = np.asarray(depth, dtype=float)
        return _kept_curve(self, depth.tobytes(), depth.shape, length)

    def _half_space_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return the force curve; a body without a length of its own has a quicker one."""
        return force_curve(self, depth, length)

    def _layer_curves(self) -> Profile | None:
        """Return the curves on a layer; None if there are none."""
        return None


# A fit with adhesion asks for the force curve and the contact radius at the same depths.
@lru_cache(maxsize=1)
def _kept_curve(
    body: BodyOfRevolution, depth: bytes, shape: tuple[int, ...], length: float
) -> ForceCurve:
    return body._half_space_curve(np.frombuffer(depth).reshape(shape), length)


@lru_cache(maxsize=64)
def _kept_layer_curves(body: BodyOfRevolution) -> Profile | None:
    # Splines are kept for each profile, which has to be the same object for equal bodies.
    return body._layer_curves()
