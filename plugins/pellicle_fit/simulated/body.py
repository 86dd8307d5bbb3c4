"""What the indenter and the solid of a configuration are to a fit."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from pellicle.components import HasForceCurve, HasLayerForceCurve, Indenter
from pellicle.errors import ConfigError
from pellicle_fit.effects.layer import Layer

from .simulation import Simulation
from .solid import solid


def body_of(
    indenter: Indenter | HasForceCurve,
    kernel: str | Mapping[str, Any] | None = None,
    poissons_ratio: float | None = None,
) -> HasForceCurve | Simulation:
    """Return what has the force curve of an indenter, or the simulation that gives one.

    The solid is that of a kernel without modulus and tension; a half-space under tension if None.

    Raises
    ------
    ConfigError, PluginError
        The kernel cannot be fitted, or is given beside a force curve that includes its solid.
    """
    if kernel is None and isinstance(indenter, HasForceCurve):
        return indenter
    if not isinstance(indenter, Indenter):
        raise ConfigError("cannot be given with a force curve, which includes its solid", "kernel")
    return Simulation(indenter, solid(kernel or "tensed_membrane", poissons_ratio))


def layer_of(
    indenter: object, kernel: str | Mapping[str, Any], poissons_ratio: float | None = None
) -> Layer | None:
    """Return the effect that a kernel is; None if it is no layer, or has to be simulated.

    A bonded layer is what is elastic and has the compliance of one at its depth and ratio.
    """
    given = solid(kernel, poissons_ratio)
    ratio, thickness = given.poissons_ratio, given.kernel.depth_to_base()
    if ratio is None or ratio < 0 or math.isinf(thickness) or given.kernel.branches():
        return None
    bonded = solid(layer_table(ratio, thickness)).kernel
    q = np.geomspace(1e-2, 1e2, 9) / thickness
    is_bonded = np.allclose(given.kernel.compliance(q), bonded.compliance(q), rtol=1e-9, atol=0)
    # A punch is too wide for the curve at any depth, or at none.
    if (
        is_bonded
        and isinstance(indenter, HasLayerForceCurve)
        and indenter.layer_depth_limit(thickness, ratio) > 0
    ):
        return Layer(thickness=thickness, poissons_ratio=ratio)
    return None


def layer_table(poissons_ratio: float, thickness: float) -> dict[str, Any]:
    """Return the table of a layer bonded to a rigid base, under tension."""
    substrate = {"type": "bonded_layer", "thickness": thickness, "poissons_ratio": poissons_ratio}
    return {"type": "coated", "substrate": substrate}
