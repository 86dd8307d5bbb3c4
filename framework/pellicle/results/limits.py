"""Solved runs far outside the theory: pressed deeper than the solid, or too steep."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.analysis.steepness import steepest
from pellicle.grid import Grid
from pellicle.units import DIGITS, readable

if TYPE_CHECKING:
    import xarray as xr

_STEEPEST = 1.0
"""Slope above which a contact without interaction is warned of; the theory is for 0.3."""
DEEP = "the surface is pressed through a layer to its rigid base"
STEEP = "slopes in contact are far beyond the theory"


def beyond_theory(dataset: xr.Dataset, configuration: Mapping[str, Any]) -> dict[str, str]:
    """Return the limits of the theory that the largest contact of a run exceeds by far.

    The keys are `DEEP` and `STEEP`, the values messages with the step and its numbers. Slopes
    under an interaction are left out: they have a status.
    """
    last = dataset.isel(step=int(np.argmax(dataset["contact_area"].values)))
    contact, displacement = last["contact"].values, last["displacement"].values
    if not contact.any() or not np.isfinite(displacement).all():
        return {}
    step, messages = int(last["step"]), {}
    thickness, deepest = base_depth(configuration["kernel"]), float(displacement[contact].max())
    if deepest > thickness:
        messages[DEEP] = (
            f"step {step}: the surface is pressed down by {readable(deepest, 'm', DIGITS)}, "
            f"through a layer {readable(thickness, 'm', DIGITS)} thick to its rigid base: the "
            "numbers are those of the equations, not of an experiment; press in less far"
        )
    slope = steepest(displacement, contact, Grid(**configuration["grid"]))
    # As it is told: an indenter of that very slope is not beyond it by rounding.
    if round(slope, 1) > _STEEPEST and not configuration.get("interaction"):
        messages[STEEP] = (
            f"step {step}: slopes in contact reach {slope:.1f}, and the theory is for slopes up to "
            "0.3: force and area are those of the equations, not of an experiment; press in less "
            "far"
        )
    return messages


def base_depth(kernel: Mapping[str, Any]) -> float:
    """Return the depth [m] of the rigid base under the layers of a kernel; ∞ if none is known."""
    if kernel.get("substrate") == "rigid":
        return math.fsum(layer["thickness"] for layer in kernel.get("layers", ())) or math.inf
    # Other kernels may call the thickness of a skin so.
    if str(kernel.get("type")).endswith("_layer") and "thickness" in kernel:
        return float(kernel["thickness"])
    inner = [base_depth(value) for value in kernel.values() if isinstance(value, Mapping)]
    return min(inner, default=math.inf)
