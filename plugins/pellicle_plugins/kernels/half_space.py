"""The elastic half-space."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import ConfigDict

from pellicle.arrays import Array

from .elastic_constants import ElasticSolid


class HalfSpace(ElasticSolid):
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
