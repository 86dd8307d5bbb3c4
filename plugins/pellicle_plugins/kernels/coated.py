"""A skin on any other kernel."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import FromRegistry, Kernel, KernelOf

from .skin import Skin


class Coated(Skin, KernelOf):
    """Skin with tension and bending stiffness on any other kernel.

    The stiffnesses of substrate and skin add at each wave number. This is exact if the skin
    transmits normal tractions only, as a tension does.
    """

    type: Literal["coated"] = "coated"
    examples = (
        {
            "tension": "0.2 N/m",
            "substrate": {
                "type": "bonded_layer",
                "youngs_modulus": "10 kPa",
                "poissons_ratio": 0.4,
                "thickness": "0.1 mm",
            },
        },
    )
    substrate: Annotated[
        Kernel,
        FromRegistry(),
        Field(
            examples=[{"type": "half_space", "reduced_modulus": "10 kPa"}],
            description="the kernel under the skin: a table with type",
        ),
    ]

    def compliance(self, q: Array) -> Array:
        """Return G(q) = 1/(1/G_s + τ₀ q² + B q⁴) [m/Pa], with G_s of the substrate."""
        substrate = self.substrate.compliance(q)
        return substrate / (1 + substrate * self.skin_stiffness(q))
