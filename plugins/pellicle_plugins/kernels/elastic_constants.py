"""The elastic constants of an isotropic solid, and kernels of such a solid."""

from __future__ import annotations

from typing import Self

from pydantic import ConfigDict, Field, model_validator

from pellicle.schema import Model
from pellicle.units import Modulus, PoissonsRatio


class ElasticModulus(Model):
    """The modulus of a solid: E*, or E and ν; E* = E/(1 − ν²)."""

    model_config = ConfigDict(
        json_schema_extra={
            "anyOf": [
                {"required": ["reduced_modulus"]},
                {"required": ["youngs_modulus", "poissons_ratio"]},
            ]
        }
    )

    reduced_modulus: Modulus | None = Field(
        None, description="reduced modulus E* [Pa]; or youngs_modulus and poissons_ratio"
    )
    youngs_modulus: Modulus | None = Field(
        None, title="Young's modulus", description="Young's modulus E [Pa], with poissons_ratio"
    )
    poissons_ratio: PoissonsRatio | None = Field(
        None, title="Poisson's ratio", description="Poisson's ratio ν, −1 < ν ≤ 0.5"
    )

    @property
    def contact_modulus(self) -> float:
        """E* [Pa]: the reduced modulus as given, or E/(1 − ν²)."""
        if self.reduced_modulus is not None:
            return self.reduced_modulus
        # Validation requires both constants where the reduced modulus is absent.
        assert self.youngs_modulus is not None
        assert self.poissons_ratio is not None
        return self.youngs_modulus / (1 - self.poissons_ratio**2)

    @model_validator(mode="after")
    def _check_constants(self) -> Self:
        both = ("youngs_modulus", "poissons_ratio")
        names = [name for name in both if getattr(self, name) is not None]
        if self.reduced_modulus is None and len(names) < 2:
            raise ValueError(
                "no modulus; give reduced_modulus, or both youngs_modulus and poissons_ratio"
            )
        if self.reduced_modulus is not None and names:
            raise ValueError(
                f"reduced_modulus and {' and '.join(names)} are both given; give "
                "reduced_modulus alone, or youngs_modulus and poissons_ratio"
            )
        return self


class ElasticConstants(ElasticModulus):
    """The constants of an isotropic solid: ν, and E or E* = E/(1 − ν²)."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [{"required": ["reduced_modulus"]}, {"required": ["youngs_modulus"]}]
        }
    )

    poissons_ratio: PoissonsRatio = Field(
        title="Poisson's ratio",
        description="Poisson's ratio ν, −1 < ν ≤ 0.5; 0.5 is incompressible",
    )

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
