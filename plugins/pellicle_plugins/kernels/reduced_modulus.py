"""The modulus fields that kernels of an elastic half-space share."""

from __future__ import annotations

from typing import Annotated, Any, Self, cast

from pydantic import (
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from pellicle.components import Kernel
from pellicle.units import Modulus, PoissonsRatio


class ElasticSolid(Kernel):
    """A kernel whose solid is given by E*, or by E and ν; E* = E/(1 − ν²)."""

    model_config = ConfigDict(
        json_schema_extra={
            "anyOf": [
                {"required": ["reduced_modulus"]},
                {"required": ["youngs_modulus", "poissons_ratio"]},
            ]
        }
    )

    # Never None once made: given, or completed from E and ν.
    reduced_modulus: Annotated[
        Modulus,
        Field(
            default_factory=lambda: cast(float, None),
            description="reduced modulus E* [Pa]; or youngs_modulus and poissons_ratio",
        ),
    ]
    youngs_modulus: Annotated[
        Modulus | None, Field(description="Young's modulus E [Pa], with poissons_ratio")
    ] = None
    poissons_ratio: Annotated[
        PoissonsRatio | None, Field(description="Poisson's ratio ν, −1 < ν ≤ 0.5")
    ] = None

    @model_validator(mode="after")
    def _complete(self) -> Self:
        by_e_nu = [
            name for name in ("youngs_modulus", "poissons_ratio") if getattr(self, name) is not None
        ]
        if self.reduced_modulus is not None:
            if by_e_nu:
                raise ValueError(
                    f"reduced_modulus and {' and '.join(by_e_nu)} are both given; give "
                    "reduced_modulus alone, or youngs_modulus and poissons_ratio"
                )
        elif self.youngs_modulus is None or self.poissons_ratio is None:
            raise ValueError(
                "no modulus; give reduced_modulus, or both youngs_modulus and poissons_ratio"
            )
        else:
            reduced = self.youngs_modulus / (1 - self.poissons_ratio**2)
            # The model is frozen for its users; this is still its construction.
            object.__setattr__(self, "reduced_modulus", reduced)
        return self

    @model_serializer(mode="wrap")
    def _as_given(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        given: dict[str, Any] = handler(self)
        if self.youngs_modulus is not None:
            del given["reduced_modulus"]
        return given
