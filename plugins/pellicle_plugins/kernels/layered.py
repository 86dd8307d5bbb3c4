"""Elastic layers glued to each other, on a half-space or a rigid base."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Final, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from pellicle.arrays import Array
from pellicle.components import Isotropic
from pellicle.errors import ConfigError, excerpt

from .elastic_constants import ElasticConstants
from .elastic_layer import Layer
from .layer_recursion import RIGID, half_space, on_layer

# Wavenumbers treated at once, so that some thirty temporaries stay in the cache.
_BLOCK: Final = 8192


def _substrate(value: object) -> object:
    """Read a table as a solid, so that an error names its field, not every alternative."""
    if isinstance(value, Mapping):
        return ElasticConstants(**value)
    if value == "rigid" or isinstance(value, ElasticConstants):
        return value
    raise ConfigError(
        f'{excerpt(value)} is not allowed; give "rigid", or a table of youngs_modulus and '
        "poissons_ratio for a half-space"
    )


class Layered(Isotropic):
    """Elastic layers glued to each other, on a half-space or a rigid base (Burmister 1945).

    One layer on a rigid base is `bonded_layer`. Waves much shorter than the uppermost layer feel
    that layer alone, waves much longer than all layers the substrate.
    """

    type: Literal["layered"] = "layered"
    examples = (
        {
            "layers": [
                {"youngs_modulus": "1 MPa", "poissons_ratio": 0.3, "thickness": "5 um"},
                {"reduced_modulus": "10 kPa", "poissons_ratio": 0.5, "thickness": "0.1 mm"},
            ],
            "substrate": {"youngs_modulus": "100 kPa", "poissons_ratio": 0.4},
        },
    )
    layers: tuple[Layer, ...] = Field(
        min_length=1,
        description="layers from the surface down: tables of youngs_modulus or "
        "reduced_modulus, poissons_ratio, thickness",
    )
    substrate: Annotated[
        ElasticConstants | Literal["rigid"],
        BeforeValidator(_substrate, json_schema_input_type=ElasticConstants | Literal["rigid"]),
    ] = Field(
        description='what the layers are glued to: "rigid", or a half-space as a table of '
        "youngs_modulus or reduced_modulus, and poissons_ratio"
    )

    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa], by a recursion from the substrate to the surface.

        Each layer takes the compliance of its lower surface for shear and normal tractions to that
        of its upper one (after Thomson 1950 and Haskell 1953, in the stable form of Dunkin 1965).
        """
        flat = q.reshape(-1)
        values = np.empty(flat.size)
        for start in range(0, flat.size, _BLOCK):
            block = slice(start, start + _BLOCK)
            values[block] = self._compliance(flat[block])
        return values.reshape(q.shape)

    def _compliance(self, q: Array) -> Array:
        if self.substrate == "rigid":
            surface, modulus = RIGID, self.layers[-1].contact_modulus
        else:
            surface = half_space(self.substrate.coupling_ratio)
            modulus = self.substrate.contact_modulus
        for layer in reversed(self.layers):
            below = surface.in_units(layer.contact_modulus / modulus)
            surface = on_layer(below, layer.thickness * q, layer.coupling_ratio)
            modulus = layer.contact_modulus
        return 2 / (modulus * q) * surface.normal

    def mean_compliance(self) -> float:
        """Return Σ h/M [m/Pa] of layers on a rigid base, M the P-wave moduli; ∞ on a half-space."""
        if self.substrate != "rigid":
            return math.inf
        return sum(layer.mean_compliance() for layer in self.layers)

    def depth_to_base(self) -> float:
        """Return Σ h [m] of layers on a rigid base; ∞ on a half-space."""
        if self.substrate != "rigid":
            return math.inf
        return math.fsum(layer.thickness for layer in self.layers)
