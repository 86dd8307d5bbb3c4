"""The elastic half-space under a skin that resists bending."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from pellicle.arrays import Array
from pellicle.units import BendingStiffness

from .elastic_constants import ElasticSolid
from .skin import Skin


class BendingSkin(Skin, ElasticSolid):
    """Elastic half-space under a skin with tension and bending stiffness (Kirchhoff plate).

    Waves with 1/q below (2B/E*)^⅓ are carried by the bending stiffness. Without it this is
    `tensed_membrane`. The shear traction between skin and solid is neglected.
    """

    type: Literal["bending_skin"] = "bending_skin"
    examples = ({"reduced_modulus": 10000.0, "tension": "0.1 N/m", "bending": "100 pN*m"},)
    bending: Annotated[
        BendingStiffness,
        Field(
            title="bending stiffness",
            description="bending stiffness B of the skin [N*m], 0 for none",
        ),
    ]

    def compliance(self, q: Array) -> Array:
        """Return G(q) = 1/(E* q/2 + τ₀ q² + B q⁴) [m/Pa]."""
        return 1 / (self.contact_modulus * q / 2 + self.skin_stiffness(q))
