"""The elastic layer on a smooth rigid base."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from pellicle import hookimpl
from pellicle.arrays import Array
from pellicle.components import Kernel

from .elastic_layer import ElasticLayer


class FrictionlessLayer(ElasticLayer):
    """Elastic layer that slips on a rigid base without lifting off (Johnson 1985).

    A layer much thicker than the contact is a half-space. A thin one is a bed of springs,
    p = E* u/h, whatever its compressibility, since it can expand sideways. Only under uniform
    pressure on a periodic domain it cannot, and Poisson's ratio matters.
    """

    type: Literal["frictionless_layer"] = "frictionless_layer"

    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa] of a layer on a smooth rigid base; Johnson 1985, section 5.8.

        G = (2/(E* q)) (cosh 2x − 1)/(sinh 2x + 2x), x = qh, multiplied here by
        e^{−2x} in numerator and denominator.
        """
        y = self._twice_depth(q)
        numerator = np.expm1(-y) ** 2
        denominator = -np.expm1(-2 * y) + 2 * y * np.exp(-y)
        return 2 / (self.contact_modulus * q) * (numerator / denominator)


@hookimpl
def register_kernels(register: Callable[[type[Kernel]], None]) -> None:
    """Register the layer on a smooth base."""
    register(FrictionlessLayer)
