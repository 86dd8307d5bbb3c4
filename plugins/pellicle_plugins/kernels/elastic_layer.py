"""What kernels of an elastic layer on a rigid base share."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from pellicle.arrays import Array
from pellicle.units import Length

from .elastic_constants import IsotropicSolid

# Where exp(−2qh) is beyond the digits of a double, and a layer is a half-space.
_DEEP = 100.0


class ElasticLayer(IsotropicSolid):
    """A kernel whose solid is a layer of finite thickness on a rigid base."""

    thickness: Annotated[Length, Field(description="thickness h of the layer [m]")]

    def mean_compliance(self) -> float:
        """Return h/M [m/Pa], M = E*(1 − ν)²/(1 − 2ν): uniaxial strain; 0 for ν = ½.

        A layer under the whole of a periodic domain cannot flow sideways, whatever its base.
        M = E(1 − ν)/((1 + ν)(1 − 2ν)) is the P-wave modulus (Johnson 1985, eq. 5.69).
        """
        nu = self.poissons_ratio
        return self.thickness * (1 - 2 * nu) / (self.reduced_modulus * (1 - nu) ** 2)

    def _twice_depth(self, q: Array) -> Array:
        """Return 2qh, cut off where nothing depends on it any more and exponentials underflow."""
        return np.minimum(2 * self.thickness * q, _DEEP)
