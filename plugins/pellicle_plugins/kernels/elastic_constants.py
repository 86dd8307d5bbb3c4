"""The elastic constants of kernels whose compliance depends on E* and on ν."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import ConfigDict, Field, model_validator

from pellicle.units import PoissonsRatio

from .reduced_modulus import ElasticSolid


class IsotropicSolid(ElasticSolid):
    """A kernel whose solid is given by ν, and by E or E* = E/(1 − ν²)."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [{"required": ["reduced_modulus"]}, {"required": ["youngs_modulus"]}]
        }
    )

    poissons_ratio: Annotated[
        PoissonsRatio, Field(description="Poisson's ratio ν, −1 < ν ≤ 0.5; 0.5 is incompressible")
    ]

    @model_validator(mode="after")
    def _check_constants(self) -> Self:
        if (self.reduced_modulus is None) == (self.youngs_modulus is None):
            moduli = "no modulus" if self.reduced_modulus is None else "two moduli"
            raise ValueError(f"{moduli}; give exactly one of reduced_modulus and youngs_modulus")
        return self
