"""The share of each cell that lies within a circle or a strip, exactly."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConfigError


def within_circle(x: Array, y: Array, radius: float) -> Array:
    """Return the share of each cell within a circle about the centre, of shape (nx, ny).

    The sum over all cells times their area is πR² to rounding. A circle that the cells do not hold
    is a ConfigError.
    """
    (left, right), (low, high) = edges(x), edges(y)
    if radius > min(right[-1, 0], high[0, -1]):
        raise ConfigError(
            f"reaches {radius:.4g} m from the centre, beyond the domain; use a larger grid.size",
            "radius",
        )
    area = _quadrant(right, high, radius) - _quadrant(left, high, radius)
    area += _quadrant(left, low, radius) - _quadrant(right, low, radius)
    share = np.clip(area / ((right - left) * (high - low)), 0.0, 1.0)
    # Differences leave rounding on cells wholly inside or outside.
    far = np.hypot(np.maximum(-left, right), np.maximum(-low, high)) <= radius
    near = np.hypot(np.maximum(np.maximum(left, -right), 0), np.maximum(np.maximum(low, -high), 0))
    share[far], share[near >= radius] = 1.0, 0.0
    return np.asarray(share)


def between(x: Array, start: float, stop: float) -> Array:
    """Return the share of each cell between two lines across x, of the shape of ``x``."""
    left, right = edges(x)
    share: Array = (np.clip(right, start, stop) - np.clip(left, start, stop)) / (right - left)
    return share


def edges(centres: Array) -> tuple[Array, Array]:
    """Return both edges of each cell [m] along an axis of two cells or more."""
    points = centres.ravel()
    if points.size < 2:
        raise ConfigError("varies across a grid one cell wide; give more grid.points")
    half = 0.5 * (points[-1] - points[0]) / (points.size - 1)
    return centres - half, centres + half


def _quadrant(x: Array, y: Array, radius: float) -> Array:
    """Return ∫₀ˣ∫₀ʸ of 1 within the circle [m²], odd in x and y."""
    a, b = np.minimum(np.abs(x), radius), np.minimum(np.abs(y), radius)
    # Up to this x the circle is above y.
    turn = np.minimum(a, np.sqrt(radius**2 - b**2))
    area: Array = b * turn + _segment(a, radius) - _segment(turn, radius)
    return np.sign(x) * np.sign(y) * area


def _segment(x: Array, radius: float) -> Array:
    """Return ∫₀ˣ √(R² − t²) dt [m²]."""
    angle = np.arcsin(np.minimum(x / radius, 1.0))
    # By one angle, whose rounding near π/2 does not matter then.
    area: Array = 0.5 * radius**2 * (angle + np.sin(angle) * np.cos(angle))
    return area
