"""Elastic solids that drain: a half-space whose pores are filled with a liquid."""

from __future__ import annotations

import math
from functools import lru_cache, partial
from typing import Annotated, Final, Literal, Self

import numpy as np
from pydantic import ConfigDict, Field, model_validator
from scipy.special import erf, erfc

from pellicle.arrays import Array
from pellicle.components import Branch, Isotropic
from pellicle.units import Modulus, Quantity

Surface = Literal["open", "sealed"]

# Rates of the branches over D q², r = 1 + e^(2y): number of them, and the first and last y. Those
# of an open surface are faster, as its liquid leaves at once where it is pressed.
_RATES: Final[dict[Surface, tuple[int, float, float]]] = {
    "open": (14, -0.75, 7.25),
    "sealed": (10, -1.75, 3.0),
}
# Times, over 1/(D q²), at which the branches are fitted.
_FITTED: Final = (1e-6, 40.0)
_SAMPLES: Final = 300
# Weight of the sum of the shares, which is exact, beside those of the samples.
_EXACT: Final = 1e3


class Poroelastic(Isotropic):
    """Half-space of a porous elastic solid whose liquid drains (Biot 1941).

    Solid and liquid are incompressible each, so that the whole is at first. The liquid leaves by
    the surface (open), or flows within the solid only (sealed). Young's modulus and Poisson's ratio
    are those of the drained solid.
    """

    model_config = ConfigDict(
        title="half-space that drains",
        json_schema_extra={
            "allOf": [
                {"oneOf": [{"required": ["shear_modulus"]}, {"required": ["youngs_modulus"]}]},
                {
                    "oneOf": [
                        {"required": ["diffusivity"]},
                        {"required": ["permeability", "viscosity"]},
                    ]
                },
            ]
        },
    )

    type: Literal["poroelastic"] = "poroelastic"
    examples = (
        {"shear_modulus": "5 kPa", "poissons_ratio": 0.3, "diffusivity": "200 um^2/s"},
        {
            "youngs_modulus": "10 kPa",
            "poissons_ratio": 0.1,
            "permeability": "10 nm^2",
            "viscosity": "1 mPa*s",
            "surface": "sealed",
        },
    )
    shear_modulus: Modulus | None = Field(
        None, description="shear modulus G [Pa]; or youngs_modulus"
    )
    youngs_modulus: Modulus | None = Field(
        None,
        title="Young's modulus",
        description="Young's modulus E = 2G(1 + ν) [Pa] of the drained solid; or shear_modulus",
    )
    poissons_ratio: Annotated[float, Quantity("1", above=-1, below=0.5)] = Field(
        title="Poisson's ratio",
        description="Poisson's ratio ν of the drained solid, −1 < ν < 0.5; near 0.5 nothing drains",
    )
    diffusivity: Annotated[float, Quantity("m2/s", above=0)] | None = Field(
        None, description="diffusivity D [m²/s] of the pore pressure; or permeability and viscosity"
    )
    permeability: Annotated[float, Quantity("m2", above=0)] | None = Field(
        None, description="permeability k of the solid [m²], with viscosity"
    )
    viscosity: Annotated[float, Quantity("Pa*s", above=0)] | None = Field(
        None, description="viscosity μ of the liquid [Pa s], with permeability"
    )
    surface: Surface = Field(
        "open",
        description='"open": the liquid passes the surface everywhere, also under the indenter; '
        '"sealed": nowhere',
    )

    @property
    def shear(self) -> float:
        """G [Pa]."""
        if self.shear_modulus is not None:
            return self.shear_modulus
        # Validation requires one of them.
        assert self.youngs_modulus is not None
        return self.youngs_modulus / (2 * (1 + self.poissons_ratio))

    @property
    def drainage_ratio(self) -> float:
        """η = (1 − ν)/(1 − 2ν)."""
        return (1 - self.poissons_ratio) / (1 - 2 * self.poissons_ratio)

    @property
    def diffusion(self) -> float:
        """D = 2Gηk/μ [m²/s]: k/μ times the P-wave modulus of the drained solid."""
        if self.diffusivity is not None:
            return self.diffusivity
        assert self.permeability is not None
        assert self.viscosity is not None
        return 2 * self.shear * self.drainage_ratio * self.permeability / self.viscosity

    def compliance(self, q: Array) -> Array:
        """Return G(q) = 1/(2Gq) [m/Pa] before anything drains, that of ν = ½."""
        return 1 / (2 * self.shear * q)

    def greens_function(self, r: Array) -> Array:
        """Return G(r) = 1/(4πG r) [m/N] before anything drains."""
        return 1 / (4 * np.pi * self.shear * r)

    def radial_primitive(self, r: Array) -> Array:
        """Return ∫₀^r G r dr = r/(4πG) [m³/N]."""
        return r / (4 * np.pi * self.shear)

    def branches(self) -> tuple[Branch, ...]:
        """Return shares of the stiffness 2Gq (1 − ψ(Dq²t)/η), and their times 1/(Dq²r)."""
        return tuple(
            Branch(share / self.drainage_ratio, partial(draining_time, self.diffusion * rate))
            for share, rate in zip(*draining_series(self.surface), strict=True)
        )

    @model_validator(mode="after")
    def _check_constants(self) -> Self:
        if (self.shear_modulus is None) == (self.youngs_modulus is None):
            moduli = "no modulus" if self.shear_modulus is None else "two moduli"
            raise ValueError(f"{moduli}; give exactly one of shear_modulus and youngs_modulus")
        flow = [
            name
            for name in ("diffusivity", "permeability", "viscosity")
            if getattr(self, name) is not None
        ]
        if flow not in (["diffusivity"], ["permeability", "viscosity"]):
            raise ValueError(
                f"{' and '.join(flow) or 'nothing'} given of how fast the liquid flows; give "
                "diffusivity alone, or both permeability and viscosity"
            )
        return self


def draining_time(rate: float, q: Array) -> Array:
    """Return the time 1/(D r q²) [s] of waves, of a ``rate`` D r [m²/s]; ∞ at q = 0."""
    with np.errstate(divide="ignore"):
        times: Array = 1 / (rate * q**2)
    return times


def drained_part(surface: Surface, theta: Array) -> Array:
    """Return ψ(θ), which grows from 0 to ½ with θ = Dq²t; of a sealed surface it is ∫ erfc √θ."""
    root, sign = np.sqrt(theta), 1 if surface == "open" else -1
    flow = root / math.sqrt(math.pi) * np.exp(-theta) - theta * erfc(root)
    psi: Array = erf(root) / 2 + sign * flow
    return psi


@lru_cache
def draining_series(surface: Surface) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return shares gⱼ > 0 and rates rⱼ of ψ(θ) = Σ g (1 − e^(−rθ)), whose sum is ½.

    With the spectrum √(r − 1)/(πr²) of an open surface and 1/(πr²√(r − 1)) of a sealed one, r > 1,
    rates in proportion to 1 + e^(2y) are uniform where the shares are. Error of ψ from θ = 1e-6 on:
    5e-5 open, 3e-6 sealed; at shorter times, at which little has drained, 3e-4.
    """
    # The import takes long, and only a solid that drains needs it.
    from scipy.optimize import lsq_linear

    number, first, last = _RATES[surface]
    rates = 1 + np.exp(2 * np.linspace(first, last, number))
    theta = np.geomspace(*_FITTED, _SAMPLES)
    terms = np.vstack([-np.expm1(-theta[:, None] * rates), np.full((1, number), _EXACT)])
    values = np.append(drained_part(surface, theta), _EXACT / 2)
    shares = lsq_linear(terms, values, (0.0, np.inf), method="bvls", tol=1e-13).x
    shares *= 0.5 / shares.sum()
    positive = shares > 0
    return tuple(shares[positive].tolist()), tuple(rates[positive].tolist())
