"""The modulus fields of kernels that need both elastic constants of their solid."""

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
    def _complete(self) -> Self:
        if (self.reduced_modulus is None) == (self.youngs_modulus is None):
            what = "no modulus" if self.reduced_modulus is None else "two moduli"
            raise ValueError(f"{what}; give exactly one of reduced_modulus and youngs_modulus")
        if self.youngs_modulus is not None:
            reduced = self.youngs_modulus / (1 - self.poissons_ratio**2)
            # The model is frozen for its users; this is still its construction.
            object.__setattr__(self, "reduced_modulus", reduced)
        return self
