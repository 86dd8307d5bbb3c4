"""The ellipse with the second moments of a contact."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, nan, pi

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.grid import Grid

_NO_CENTRE = 1e-6


@dataclass(frozen=True)
class Ellipse:
    """An ellipse in the plane of the surface."""

    x: float
    """Centre along x [m]."""
    y: float
    """Centre along y [m]."""
    semi_major_axis: float
    """Major semi-axis [m]."""
    semi_minor_axis: float
    """Minor semi-axis [m]."""
    angle: float
    """Angle from the x axis to the major axis [rad], −π/2 to π/2; arbitrary for a circle."""


def ellipse(contact: ArrayLike, grid: Grid) -> Ellipse:
    """Return the ellipse with the centroid and the second moments of a contact, bool (nx, ny).

    A full ellipse with semi-axes a₁ ≥ a₂ has the principal second moments a₁²/4 and a₂²/4 per
    area. Cells count as rectangles, so that a single cell has an extent. Without contact the
    semi-axes are 0, centre and angle NaN. On a periodic grid positions are relative to the circular
    mean of the contact along each axis. If that is undefined, as in full contact or a line contact,
    all values are NaN.
    """
    inside = np.asarray(contact, dtype=bool)
    if not inside.any():
        return Ellipse(nan, nan, 0.0, 0.0, nan)
    x, y = (points.ravel() for points in grid.coordinates())
    along = inside.sum(axis=1, dtype=np.float64), inside.sum(axis=0, dtype=np.float64)
    centre = [0.0, 0.0]
    if grid.boundary == "periodic":
        centre = list(map(_circular_mean, (x, y), along, grid.size))
        if np.isnan(centre).any():
            return Ellipse(nan, nan, nan, nan, nan)
    x, y = (
        _wrapped(points - middle, length) if grid.boundary == "periodic" else points
        for points, middle, length in zip((x, y), centre, grid.size, strict=True)
    )
    mean_x, mean_y = np.average(x, weights=along[0]), np.average(y, weights=along[1])
    x, y = x - mean_x, y - mean_y
    dx, dy = grid.spacing
    xx = float(np.average(x**2, weights=along[0])) + dx**2 / 12
    yy = float(np.average(y**2, weights=along[1])) + dy**2 / 12
    xy = float(x @ (inside @ y)) / along[0].sum()
    minor, major = np.linalg.eigvalsh([[xx, xy], [xy, yy]])
    return Ellipse(
        x=float(_wrapped(np.asarray(centre[0] + mean_x), grid.size[0])),
        y=float(_wrapped(np.asarray(centre[1] + mean_y), grid.size[1])),
        semi_major_axis=2 * float(np.sqrt(major)),
        semi_minor_axis=2 * float(np.sqrt(max(minor, 0.0))),
        angle=atan2(2 * xy, xx - yy) / 2,
    )


def _circular_mean(points: Array, weights: Array, length: float) -> float:
    """Return the circular mean of positions of a period; NaN if it is undefined."""
    if points.size == 1:
        return nan
    resultant = np.average(np.exp(2j * pi / length * points), weights=weights)
    return nan if abs(resultant) < _NO_CENTRE else float(np.angle(resultant)) * length / (2 * pi)


def _wrapped(points: Array, length: float) -> Array:
    """Return the periodic images of points within half a period of 0."""
    return points - length * np.round(points / length)
