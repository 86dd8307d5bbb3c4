"""The true profile of the indenter of a run, drawn to scale."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pellicle.arrays import Array
from pellicle.components.calls import profile_of
from pellicle.units import axis_unit

from .run import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_CELLS = 512
"""Cells along an edge up to which the indenter is drawn on the grid of the run."""


def profile_along_x(run: Run) -> tuple[Array, Array]:
    """Return x and the height of the indenter above its lowest point, which they cut [m].

    Where there is no indenter the height is NaN.
    """
    nx, ny = run.grid.points
    coarser = max(1.0, max(nx, ny) / _CELLS)
    points = math.ceil(nx / coarser), math.ceil(ny / coarser)
    grid = run.grid.model_copy(update={"points": points})
    profile = profile_of(run.indenter, grid)
    _, lowest = np.unravel_index(np.argmax(profile), profile.shape)
    height = -profile[:, lowest]
    return grid.coordinates()[0][:, 0], np.where(np.isfinite(height), height, np.nan)


def draw_indenter(axes: Axes, run: Run) -> None:
    """Draw the indenter of a run above the surface that it touches first."""
    x, height = profile_along_x(run)
    length, unit = axis_unit(x, "m")
    # A flat punch has no height.
    scale, height_unit = axis_unit(height, "m") if np.nanmax(height) else (length, unit)
    axes.plot(x * length, height * scale)
    axes.axhline(0, color="0.4", linewidth=0.8, linestyle="--")
    axes.set(xlabel=f"x [{unit}]", ylabel=f"indenter [{height_unit}]")
