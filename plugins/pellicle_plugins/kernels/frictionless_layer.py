"""The elastic layer on a smooth rigid base."""

from __future__ import annotations

from typing import Literal

import numpy as np

from pellicle.arrays import Array

from .elastic_layer import ElasticLayer


class FrictionlessLayer(ElasticLayer):
    """Elastic layer that slips on a rigid base without lifting off (Johnson 1985).

    A layer much thicker than the contact acts as a half-space. A thin one acts as a bed of springs,
    p = E* u/h, whatever its compressibility, since it can expand sideways. Only under a uniform
    pressure on a periodic domain can it not expand, and Poisson's ratio matters.
    """

    type: Literal["frictionless_layer"] = "frictionless_layer"

    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa] of a layer on a smooth rigid base; Johnson 1985, section 5.8.

        G = (2/(E* q)) (cosh 2x − 1)/(sinh 2x + 2x), x = qh, with numerator and denominator
        multiplied here by 2e^{−2x}.
        """
        y = self._twice_depth(q)
        numerator = np.expm1(-y) ** 2
        denominator = -np.expm1(-2 * y) + 2 * y * np.exp(-y)
        return 2 / (self.contact_modulus * q) * (numerator / denominator)
