"""Solved runs beyond theory or grid: deeper than the solid, too steep, pulled off on few cells."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pellicle.analysis.steepness import steepest
from pellicle.grid import Grid
from pellicle.units import DIGITS, readable

from .path import has_interaction, path_variables

if TYPE_CHECKING:
    import xarray as xr

_STEEPEST = 1.0
"""Slope above which a contact without interaction is warned of; the theory is for 0.3."""
_CELLS = 12
"""Cells in the radius at pull-off below which its force is warned of."""
DEEP = "the surface is pressed through a layer to its rigid base"
STEEP = "slopes in contact are far beyond the theory"
PULL_OFF = "the pull-off force is that of a contact of few cells"


def beyond_theory(dataset: xr.Dataset, grid: Grid) -> dict[str, str]:
    """Return the limits that the largest contact of a run, or that at pull-off, exceeds by far.

    The keys are `DEEP`, `STEEP` and `PULL_OFF`, the values messages with the step and its numbers.
    Slopes under an interaction are left out: they have a status. So is pull-off by a range that is
    not that of the cells: no error of its force is known.
    """
    messages, summary = {}, path_variables(dataset)
    cells = summary.get("pull_off_radius", math.nan) / math.sqrt(grid.cell_area)
    if "force_error" in dataset and 0 < cells < _CELLS and min(grid.shape) > 1:
        error = summary["pull_off_accuracy"] / -summary["pull_off"]
        off = f"may be off by {error:.0%}" if math.isfinite(error) else "has no known error"
        messages[PULL_OFF] = (
            f"step {summary['pull_off_step']:.0f}: at pull-off the radius of the contact has "
            f"{cells:.1f} cells, so the pull-off force {off}; use more points, or a smaller "
            "grid.size"
        )
    last = dataset.isel(step=int(np.argmax(dataset["contact_area"].values)))
    contact, displacement = last["contact"].values, last["displacement"].values
    if not contact.any() or not np.isfinite(displacement).all():
        return messages
    step = int(last["step"])
    thickness, deepest = dataset.attrs["depth_to_base"], float(displacement[contact].max())
    if deepest > thickness:
        messages[DEEP] = (
            f"step {step}: the surface is pressed down by {readable(deepest, 'm', DIGITS)}, "
            f"through a layer {readable(thickness, 'm', DIGITS)} thick to its rigid base: the "
            "numbers are those of the equations, not of an experiment; press in less far"
        )
    slope = steepest(displacement, contact, grid)
    # As it is told: an indenter of that very slope is not beyond it by rounding.
    if round(slope, 1) > _STEEPEST and not has_interaction(dataset):
        messages[STEEP] = (
            f"step {step}: slopes in contact reach {slope:.1f}, and the theory is for slopes up to "
            "0.3: force and area are those of the equations, not of an experiment; press in less "
            "far"
        )
    return messages
