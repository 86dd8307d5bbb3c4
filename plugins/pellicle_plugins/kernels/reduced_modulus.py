"""The elastic modulus of a solid, and kernels whose compliance depends on E* alone."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import ConfigDict, Field, model_validator

from pellicle.components import Kernel
from pellicle.model import Model
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

    reduced_modulus: Annotated[
        Modulus | None,
        Field(description="reduced modulus E* [Pa]; or youngs_modulus and poissons_ratio"),
    ] = None
    youngs_modulus: Annotated[
        Modulus | None,
        Field(title="Young's modulus", description="Young's modulus E [Pa], with poissons_ratio"),
    ] = None
    poissons_ratio: Annotated[
        PoissonsRatio | None,
        Field(title="Poisson's ratio", description="Poisson's ratio ν, −1 < ν ≤ 0.5"),
    ] = None

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


class ElasticSolid(ElasticModulus, Kernel):
    """A kernel whose solid is given by E*, or by E and ν."""
