"""Skins under tension that may resist bending: on a half-space, and on any other kernel."""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal

import numpy as np
from pydantic import ConfigDict, Field

from pellicle.arrays import Array
from pellicle.components import FromRegistry, Isotropic, Kernel, KernelOf
from pellicle.units import BendingStiffness, Tension

from .elastic_constants import ElasticConstants, ElasticModulus
from .tensions import TENSION, SkinTensions, Tensions

_BENDING: Final[Any] = {
    "title": "bending stiffness",
    "description": "bending stiffness B of the skin [N*m], 0 for none",
}


class Skin(Kernel):
    """A kernel whose surface is a skin under tension that may resist bending."""

    tension: Tension = Field(
        0.0, title="surface tension", description="tension τ₀ of the skin [N/m], 0 for none"
    )
    bending: BendingStiffness = Field(0.0, **_BENDING)

    def skin_stiffness(self, q: Array) -> Array:
        """Return τ₀ q² + B q⁴ [Pa/m], a plate under tension; Timoshenko & Woinowsky-Krieger 1959.

        It adds to the stiffness 1/G(q) of the solid to which the skin is bonded.
        """
        return (self.tension + self.bending * q**2) * q**2


class BendingSkin(Skin, ElasticModulus, Isotropic):
    """Elastic half-space under a skin with tension and bending stiffness (Kirchhoff plate).

    Waves with 1/q below (2B/E*)^⅓ are carried by the bending stiffness. Without it this is
    `tensed_membrane`. The shear traction between skin and solid is neglected.
    """

    type: Literal["bending_skin"] = "bending_skin"
    examples = ({"reduced_modulus": "10 kPa", "tension": "0.1 N/m", "bending": "100 pN*m"},)
    bending: BendingStiffness = Field(**_BENDING)

    def compliance(self, q: Array) -> Array:
        """Return G(q) = 1/(E* q/2 + τ₀ q² + B q⁴) [m/Pa]."""
        return 1 / (self.contact_modulus * q / 2 + self.skin_stiffness(q))


class GurtinMurdoch(Skin, ElasticConstants, Isotropic):
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
    surface_stiffness: Tension = Field(
        description="stiffness κ_s = λ_s + 2μ_s of the surface in its plane [N/m]"
    )

    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa] of surface elasticity after Gurtin & Murdoch 1975.

        1/G = (E* q/2)(1 + η)/(1 + (1 − g²)η) + τ₀ q² + B q⁴ with η = 2κ_s q/E* and
        g = (1 − 2ν)/(2(1 − ν)), the ratio of sideways to normal displacement without surface
        elasticity.
        """
        eta = 2 * self.surface_stiffness * q / self.contact_modulus
        hindered = (1 + eta) / (1 + (1 - self.coupling_ratio**2) * eta)
        return 1 / (self.contact_modulus * q / 2 * hindered + self.skin_stiffness(q))


class Coated(SkinTensions, KernelOf):
    """Skin with tension and bending stiffness on any other kernel.

    The stiffnesses of substrate and skin add at each wave. This is exact if the skin transmits
    normal tractions only, as a tension does.
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
    tension: Tensions = Field(0.0, **TENSION)
    bending: BendingStiffness = Field(0.0, **_BENDING)
    substrate: Annotated[Kernel, FromRegistry()] = Field(
        description="the kernel under the skin: a table with type"
    )

    @property
    def is_isotropic(self) -> bool:
        """Whether the substrate is, and the tension is the same in all directions."""
        return self.has_one_tension and self.substrate.is_isotropic

    def symbol(self, qx: Array, qy: Array) -> Array:
        """Return G(q) = 1/(1/G_s + qᵀTq + B q⁴) [m/Pa], with G_s of the substrate."""
        substrate, q = self.substrate.symbol(qx, qy), np.hypot(qx, qy)
        if self.has_one_tension:
            skin = (self.one_tension + self.bending * q**2) * q**2
        else:
            skin = self.tension_stiffness(qx, qy) + self.bending * q**4
        compliance: Array = substrate / (1 + substrate * skin)
        return compliance
