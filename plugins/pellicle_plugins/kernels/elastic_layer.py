"""Elastic layers on a rigid base, with and without slip."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import Isotropic
from pellicle.units import Length

from .elastic_constants import ElasticConstants
from .hyperbolic import DEEP, scaled_sinh_rest


class Layer(ElasticConstants):
    """One elastic layer."""

    thickness: Length = Field(description="thickness h of the layer [m]")

    def mean_compliance(self) -> float:
        """Return h/M [m/Pa], M the P-wave modulus: uniaxial strain; 0 for ν = ½.

        A layer that fills a periodic domain cannot flow sideways, whatever its base.
        """
        return self.thickness * self.uniaxial_compliance


class ElasticLayer(Layer, Isotropic):
    """A kernel whose solid is a layer of finite thickness on a rigid base."""

    def depth_to_base(self) -> float:
        """Return the thickness h [m]."""
        return self.thickness

    def _twice_depth(self, q: Array) -> Array:
        """Return 2qh, limited to `DEEP` so that exp does not underflow."""
        return np.minimum(2 * self.thickness * q, DEEP)


class BondedLayer(ElasticLayer):
    """Elastic layer bonded to a rigid base (Hayes et al. 1972).

    A layer much thicker than the contact acts as a half-space, a thin compressible one as a bed of
    springs, p = M u/h. A thin incompressible layer can only flow sideways, G = (h³/3μ) q², and is
    the stiffer the longer the wave.
    """

    type: Literal["bonded_layer"] = "bonded_layer"
    examples = ({"reduced_modulus": "10 kPa", "poissons_ratio": 0.5, "thickness": "0.2 mm"},)

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


class FrictionlessLayer(ElasticLayer):
    """Elastic layer that slips on a rigid base without lifting off (Johnson 1985).

    A layer much thicker than the contact acts as a half-space. A thin one acts as a bed of springs,
    p = E* u/h, whatever its compressibility, since it can expand sideways. Only under a uniform
    pressure on a periodic domain can it not expand, and Poisson's ratio matters.
    """

    type: Literal["frictionless_layer"] = "frictionless_layer"
    examples = ({"youngs_modulus": "9 kPa", "poissons_ratio": 0.3, "thickness": "0.1 mm"},)

    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa] of a layer on a smooth rigid base; Johnson 1985, section 5.8.

        G = (2/(E* q)) (cosh 2x − 1)/(sinh 2x + 2x), x = qh, with numerator and denominator
        multiplied here by 2e^{−2x}.
        """
        y = self._twice_depth(q)
        numerator = np.expm1(-y) ** 2
        denominator = -np.expm1(-2 * y) + 2 * y * np.exp(-y)
        return 2 / (self.contact_modulus * q) * (numerator / denominator)
