"""Height, width and volume of a surface that is pulled up and pushed down by a load."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle.grid import Grid

# Points in a cell at which a section across a ridge is interpolated.
_FINE = 64


class Ridge(NamedTuple):
    """Numbers of a surface, against the datum of its displacements."""

    ridge_height: float
    """Height of the highest point [m], 0 if none lies above the datum."""
    ridge_width: float
    """Width [m] at half of the height, across the ridge; NaN where it does not end."""
    ridge_volume: float
    """Volume above the datum [m³]."""
    dimple_depth: float
    """Depth of the deepest point [m], 0 if none lies below the datum."""
    dimple_volume: float
    """Volume below the datum [m³]."""


def ridge(displacement: Array, grid: Grid) -> Ridge:
    """Return the numbers of a surface, given its displacement into the solid [m].

    The datum is the undeformed surface far away; on a periodic grid, on a kernel without a
    compliance for q = 0, it is the mean plane. The width is measured through the highest cell, in
    the direction in which the surface bends most.
    """
    height = np.maximum(-displacement, 0.0)
    depth = np.maximum(displacement, 0.0)
    return Ridge(
        float(height.max()),
        _width(height, grid) if height.any() and height.size > 1 else np.nan,
        float(height.sum()) * grid.cell_area,
        float(depth.max()),
        float(depth.sum()) * grid.cell_area,
    )


def _width(height: Array, grid: Grid) -> float:
    """Return the full width at half maximum [m] of the section across the highest cell."""
    from scipy.ndimage import map_coordinates

    mode = "grid-wrap" if grid.boundary == "periodic" else "constant"
    top = np.unravel_index(np.argmax(height), height.shape)
    step = min(grid.spacing) / _FINE
    middle = int(0.5 * max(grid.size) / step)
    along = step * np.arange(-middle, middle + 1)
    points = [
        index + along * part / edge
        for index, part, edge in zip(top, _across(height, top, grid), grid.spacing, strict=True)
    ]
    (low,) = np.nonzero(map_coordinates(height, points, order=1, mode=mode) < 0.5 * height[top])
    left, right = low[low < middle], low[low > middle]
    return step * float(right[0] - left[-1] - 1) if left.size and right.size else np.nan


def _across(height: Array, top: tuple[np.intp, ...], grid: Grid) -> Array:
    """Return the unit vector along which the surface bends most at a cell."""
    if 1 in height.shape:
        return np.array([float(n > 1) for n in height.shape])
    by_axis = [np.gradient(slope, *grid.spacing) for slope in np.gradient(height, *grid.spacing)]
    bends = np.array([[second[top] for second in seconds] for seconds in by_axis])
    values, vectors = np.linalg.eigh(0.5 * (bends + bends.T))
    return np.asarray(vectors[:, np.argmax(np.abs(values))])
