"""The elastic constants of an isotropic solid, and kernels whose compliance depends on both."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import ConfigDict, Field, model_validator

from pellicle.components import Kernel
from pellicle.units import PoissonsRatio

from .reduced_modulus import ElasticModulus


class ElasticConstants(ElasticModulus):
    """The constants of an isotropic solid: ν, and E or E* = E/(1 − ν²)."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [{"required": ["reduced_modulus"]}, {"required": ["youngs_modulus"]}]
        }
    )

    poissons_ratio: Annotated[
        PoissonsRatio,
        Field(
            title="Poisson's ratio",
            examples=[0.45],
            description="Poisson's ratio ν, −1 < ν ≤ 0.5; 0.5 is incompressible",
        ),
    ]

    @property
    def coupling_ratio(self) -> float:
        """Ratio g = (1 − 2ν)/(2(1 − ν)) of sideways to normal displacement of a half-space."""
        return (1 - 2 * self.poissons_ratio) / (2 * (1 - self.poissons_ratio))

    @property
    def uniaxial_compliance(self) -> float:
        """1/M [1/Pa], M = E*(1 − ν)²/(1 − 2ν): strain per pressure without sideways strain.

        M = E(1 − ν)/((1 + ν)(1 − 2ν)) is the P-wave modulus (Johnson 1985, eq. 5.69); 1/M is 0 for
        ν = ½.
        """
        nu = self.poissons_ratio
        return (1 - 2 * nu) / (self.contact_modulus * (1 - nu) ** 2)

    @model_validator(mode="after")
    def _check_constants(self) -> Self:
        if (self.reduced_modulus is None) == (self.youngs_modulus is None):
            moduli = "no modulus" if self.reduced_modulus is None else "two moduli"
            raise ValueError(f"{moduli}; give exactly one of reduced_modulus and youngs_modulus")
        return self


class IsotropicSolid(ElasticConstants, Kernel):
    """A kernel whose solid is given by ν, and by E or E*."""
