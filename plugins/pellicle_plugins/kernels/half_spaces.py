"""The elastic half-space, with and without a tension of its surface."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import ConfigDict

from pellicle.arrays import Array
from pellicle.components import Isotropic

from .elastic_constants import ElasticModulus
from .struve import struve_minus_bessel, struve_minus_bessel_primitive
from .tensions import SkinTensions


class HalfSpace(ElasticModulus, Isotropic):
    """Elastic half-space without surface tension (Boussinesq 1885)."""

    model_config = ConfigDict(title="half-space")

    type: Literal["half_space"] = "half_space"
    examples = ({"reduced_modulus": "10 kPa"},)

    def compliance(self, q: Array) -> Array:
        """Return G(q) = 2/(E* q) [m/Pa]; Johnson 1985, section 13.2."""
        return 2.0 / (self.contact_modulus * q)

    def greens_function(self, r: Array) -> Array:
        """Return G(r) = 1/(π E* r) [m/N]; Johnson 1985, eq. 3.22a."""
        return 1.0 / (np.pi * self.contact_modulus * r)

    def radial_primitive(self, r: Array) -> Array:
        """Return ∫₀^r G r dr = r/(π E*) [m³/N]."""
        return r / (np.pi * self.contact_modulus)


class TensedMembrane(SkinTensions, ElasticModulus, Isotropic):
    """Elastic half-space under a skin of constant tension (Hajji 1978).

    On a periodic boundary the tension along one direction may differ from that across it.
    """

    type: Literal["tensed_membrane"] = "tensed_membrane"
    examples = ({"reduced_modulus": "10 kPa", "tension": "1 N/m"},)

    @property
    def is_isotropic(self) -> bool:
        """Whether the tension is the same in all directions."""
        return self.has_one_tension

    @property
    def elastocapillary_length(self) -> float:
        """Length s = 2τ₀/E* [m], below which the tension outweighs the elasticity."""
        return 2 * self.one_tension / self.contact_modulus

    def compliance(self, q: Array) -> Array:
        """Return G(q) = 1/(E* q/2 + τ₀ q²) [m/Pa]; Hajji 1978."""
        return 1.0 / (self.contact_modulus * q / 2 + self.one_tension * q**2)

    def symbol(self, qx: Array, qy: Array) -> Array:
        """Return G(q) = 1/(E* q/2 + qᵀTq) [m/Pa], T the tensor of the tension."""
        if self.is_isotropic:
            return super().symbol(qx, qy)
        solid = self.contact_modulus * np.hypot(qx, qy) / 2
        return 1.0 / (solid + self.tension_stiffness(qx, qy))

    def greens_function(self, r: Array) -> Array:
        """Return G(r) = [H₀(r/s) − Y₀(r/s)]/(2 s E*) [m/N]; Hajji 1978."""
        s = self.elastocapillary_length
        if s == 0:
            return 1.0 / (np.pi * self.contact_modulus * r)
        return struve_minus_bessel(r / s) / (2 * s * self.contact_modulus)

    def radial_primitive(self, r: Array) -> Array:
        """Return ∫₀^r G r dr = (s/2E*)[z(H₁(z) − Y₁(z)) − 2/π], z = r/s [m³/N]."""
        s = self.elastocapillary_length
        if s == 0:
            return r / (np.pi * self.contact_modulus)
        return struve_minus_bessel_primitive(r / s) * (s / (2 * self.contact_modulus))
