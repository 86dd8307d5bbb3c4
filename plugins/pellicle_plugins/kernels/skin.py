"""The fields and the stiffness of a skin under tension that may resist bending."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import Kernel
from pellicle.units import BendingStiffness, Tension


class Skin(Kernel):
    """A kernel whose surface is a skin under tension that may resist bending."""

    tension: Annotated[
        Tension,
        Field(
            title="surface tension",
            examples=["5 mN/m"],
            description="tension τ₀ of the skin [N/m], 0 for none",
        ),
    ] = 0.0
    bending: Annotated[
        BendingStiffness,
        Field(
            title="bending stiffness",
            description="bending stiffness B of the skin [N*m], 0 for none",
        ),
    ] = 0.0

    def skin_stiffness(self, q: Array) -> Array:
        """Return τ₀ q² + B q⁴ [Pa/m], a plate under tension; Timoshenko & Woinowsky-Krieger 1959.

        It adds to the stiffness 1/G(q) of the solid to which the skin is bonded.
        """
        return (self.tension + self.bending * q**2) * q**2
