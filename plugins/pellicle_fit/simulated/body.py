"""What the indenter and the solid of a configuration are to a fit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

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


def layer_of(indenter: object, poissons_ratio: float, thickness: float) -> Layer | None:
    """Return the effect of a layer bonded to a rigid base; None if it has to be simulated."""
    if not isinstance(indenter, HasLayerForceCurve) or poissons_ratio < 0:
        return None
    # A punch is too wide for the curve at any depth, or at none.
    is_known = indenter.layer_depth_limit(thickness, poissons_ratio) > 0
    return Layer(thickness=thickness, poissons_ratio=poissons_ratio) if is_known else None


def layer_table(poissons_ratio: float, thickness: float) -> dict[str, Any]:
    """Return the table of a layer bonded to a rigid base, under tension."""
    substrate = {"type": "bonded_layer", "thickness": thickness, "poissons_ratio": poissons_ratio}
    return {"type": "coated", "substrate": substrate}
