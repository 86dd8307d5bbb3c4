"""The elastic half-space whose surface is itself elastic."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from pellicle.arrays import Array
from pellicle.units import Tension

from .elastic_constants import ElasticConstants
from .skin import Skin


class GurtinMurdoch(Skin, ElasticConstants):
    """Elastic half-space whose surface resists stretching too (Gurtin & Murdoch 1975).

    The surface has a residual tension τ₀ and a stiffness κ_s = λ_s + 2μ_s against in-plane strain.
    Pressure also displaces the surface of a compressible solid sideways, which the surface
    stiffness hinders. For ν = ½, without sideways displacement, and for κ_s = 0 this is
    `tensed_membrane`.
    """

    model_config = ConfigDict(title="Gurtin–Murdoch surface")

    type: Literal["gurtin_murdoch"] = "gurtin_murdoch"
    examples = (
        {
            "youngs_modulus": "9 kPa",
            "poissons_ratio": 0.3,
            "surface_stiffness": "2 N/m",
            "tension": "0.5 N/m",
        },
    )
    surface_stiffness: Annotated[
        Tension, Field(description="stiffness κ_s = λ_s + 2μ_s of the surface in its plane [N/m]")
    ]

    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa] of surface elasticity after Gurtin & Murdoch 1975.

        1/G = (E* q/2)(1 + η)/(1 + (1 − g²)η) + τ₀ q² + B q⁴ with η = 2κ_s q/E* and
        g = (1 − 2ν)/(2(1 − ν)), the ratio of sideways to normal displacement without surface
        elasticity.
        """
        eta = 2 * self.surface_stiffness * q / self.contact_modulus
        hindered = (1 + eta) / (1 + (1 - self.coupling_ratio**2) * eta)
        return 1 / (self.contact_modulus * q / 2 * hindered + self.skin_stiffness(q))
