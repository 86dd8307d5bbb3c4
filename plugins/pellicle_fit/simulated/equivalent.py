"""The body of revolution on a half-space that has a given force without tension."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Any, ClassVar

import numpy as np

from pellicle.arrays import Array

_POINTS, _RISE = 8, 1e-3
"""Points of h for each depth, and the least rise of the logarithm of the radius between two."""
_POWERS = 0.5, 4.0
"""Least and greatest power of the radius with which h grows beyond its ends."""


@dataclass(frozen=True, eq=False)
class EquivalentBody:
    """Body with the forces F₀/E* [m²] at some depths [m] on a half-space without tension.

    Log F₀ is a cubic spline of log δ. Since dF₀/dδ = 2E*a, and δ = h(a), it gives the transform h
    (Sneddon 1965; see `HasAbelSlope`).
    """

    depths: Array
    forces: Array

    contact_radius_limit: ClassVar[float] = inf
    pointed: ClassVar[bool] = False

    def log_force(self, log_depth: Array) -> tuple[Array, Array, Array]:
        """Return log F₀/E* and its slope over log δ, linear beyond the depths; and a = ¾ F₀/δ."""
        inside = np.clip(log_depth, *self._spline.x[[0, -1]])
        slope = self._spline(inside, 1)
        value = self._spline(inside) + slope * (log_depth - inside)
        return value, slope, 0.75 * np.exp(value - log_depth)

    def abel_transform(self, x: Array) -> Array:
        """Return h(x) [m] at positions [m] of any shape."""
        return self._transform(x)[0]

    def abel_slope(self, x: Array) -> Array:
        """Return h'(x) at positions [m] of any shape."""
        value, power = self._transform(x)
        return value / x * power

    @cached_property
    def _spline(self) -> Any:
        from scipy.interpolate import CubicSpline

        return CubicSpline(np.log(self.depths), np.log(self.forces))

    @cached_property
    def _log_transform(self) -> Any:
        """Log h over log x, increasing."""
        from scipy.interpolate import PchipInterpolator

        first, last = np.log(self.depths[[0, -1]])
        log_depth = np.linspace(first, last, _POINTS * (self.depths.size - 1) + 1)
        force, slope, _ = self.log_force(log_depth)
        log_radius = np.log(slope / 2) + force - log_depth
        grows = np.diff(np.maximum.accumulate(log_radius), prepend=-inf) > _RISE
        return PchipInterpolator(log_radius[grows], log_depth[grows])

    def _transform(self, x: Array) -> tuple[Array, Array]:
        """Return h(x) [m], and the power of x with which it grows."""
        spline, log = self._log_transform, np.log(x)
        inside = np.clip(log, *spline.x[[0, -1]])
        power = spline(inside, 1)
        power = np.where(inside == log, power, np.clip(power, *_POWERS))
        return np.exp(spline(inside) + power * (log - inside)), power
