"""The fields of kernels for an elastic layer on a rigid base."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from pellicle.arrays import Array
from pellicle.units import Length

from .elastic_constants import IsotropicSolid
from .hyperbolic import DEEP


class ElasticLayer(IsotropicSolid):
    """A kernel whose solid is a layer of finite thickness on a rigid base."""

    thickness: Annotated[Length, Field(description="thickness h of the layer [m]")]

    def mean_compliance(self) -> float:
        """Return h/M [m/Pa], M the P-wave modulus: uniaxial strain; 0 for ν = ½.

        A layer that fills a periodic domain cannot flow sideways, whatever its base.
        """
        return self.thickness * self.uniaxial_compliance

    def _twice_depth(self, q: Array) -> Array:
        """Return 2qh, limited to `DEEP` so that exp does not underflow."""
        return np.minimum(2 * self.thickness * q, DEEP)
