"""The true profile of the indenter of a run, drawn to scale."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pellicle.components.calls import profile_of
from pellicle.units import axis_unit

from .run import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_CELLS = 512
"""Cells along an edge up to which the indenter is drawn on the grid of the run."""


def draw_indenter(axes: Axes, run: Run) -> None:
    """Draw the indenter of a run along x, through its lowest point, above the flat surface."""
    grid = run.grid
    # An indenter that fills the domain, such as measured heights, is tied to its cells.
    if max(grid.points) > _CELLS and run.indenter.footprint != "domain":
        coarser = max(grid.points) / _CELLS
        points = tuple(math.ceil(n / coarser) for n in grid.points)
        grid = grid.model_copy(update={"points": points})
    x, profile = grid.coordinates()[0][:, 0], profile_of(run.indenter, grid)
    _, lowest = np.unravel_index(np.argmax(profile), profile.shape)
    height = -profile[:, lowest]
    height[~np.isfinite(height)] = np.nan
    length, unit = axis_unit(x, "m")
    # A flat punch has no height.
    scale, height_unit = axis_unit(height, "m") if np.nanmax(height) else (length, unit)
    axes.plot(x * length, height * scale)
    axes.axhline(0, color="0.4", linewidth=0.8, linestyle="--")
    axes.set(xlabel=f"x [{unit}]", ylabel=f"indenter [{height_unit}]")
