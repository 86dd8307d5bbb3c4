"""The elastic layer bonded to a rigid base."""

from __future__ import annotations

from typing import Literal

import numpy as np

from pellicle.arrays import Array

from .elastic_layer import ElasticLayer
from .hyperbolic import scaled_sinh_rest


class BondedLayer(ElasticLayer):
    """Elastic layer bonded to a rigid base (Hayes et al. 1972).

    A layer much thicker than the contact acts as a half-space, a thin compressible one as a bed of
    springs, p = M u/h. A thin incompressible layer can only flow sideways, G = (h³/3μ) q², and is
    the stiffer the longer the wave.
    """

    type: Literal["bonded_layer"] = "bonded_layer"

    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa] of a layer on a rigid base without slip; Hayes et al. 1972.

        G = (2/(E* q)) [κ sinh 2x − 2x]/[κ cosh 2x + 2x² + 5 − 12ν + 8ν²], κ = 3 − 4ν, x = qh,
        multiplied here by e^{−2x} in numerator and denominator, with
        κ sinh 2x − 2x = κ (sinh 2x − 2x) + 4(1 − 2ν)x.
        """
        nu, y = self.poissons_ratio, self._twice_depth(q)
        kappa, decay = 3 - 4 * nu, np.exp(-y)
        numerator = kappa * scaled_sinh_rest(y) + 2 * (1 - 2 * nu) * y * decay
        denominator = kappa * (1 + decay**2) / 2 + (y**2 / 2 + 5 - 12 * nu + 8 * nu**2) * decay
        return 2 / (self.contact_modulus * q) * (numerator / denominator)

    def bonded_layer(self) -> tuple[float, float]:
        """Return h [m] and ν."""
        return self.thickness, self.poissons_ratio
