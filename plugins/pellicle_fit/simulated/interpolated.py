"""A force curve interpolated between simulated contacts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import RectBivariateSpline

from pellicle.arrays import Array
from pellicle.components import ForceCurve

SCALE = 0.1
"""Ratio of s to contact width at which the spacing of nodes turns from uniform to logarithmic."""


def stretched(x: Array) -> Array:
    """Return log(1 + x/SCALE), on which log F is smooth from no tension to tension alone."""
    return np.log1p(x / SCALE)


@dataclass(frozen=True, eq=False)
class SimulatedCurve:
    """F/E* of an indenter on a solid under tension, interpolated between the runs of a study.

    log(F/E*) is a cubic spline of log δ and of `stretched` s/w; beyond the nodes it is extrapolated
    linearly.
    """

    depths: Array
    """Depths δ of nodes [m], increasing, of shape (m,)."""
    ratios: Array
    """Ratios s/w of nodes, increasing from 0, of shape (n,)."""
    width: tuple[float, float]
    """Slope of log w over log δ, and its value at δ = 1 m; w is about the width of the contact."""
    log_forces: Array
    """log(F/E*) in m², of shape (m, n)."""
    accuracy: float = 0.0
    """Largest relative change of a force when the cells along each axis are halved."""
    half_space: bool = True
    """Whether the solid under the skin is one."""

    @property
    def depth_limit(self) -> float:
        """Depth [m] of the deepest node."""
        return float(self.depths[-1])

    @cached_property
    def _spline(self) -> RectBivariateSpline:
        return RectBivariateSpline(np.log(self.depths), stretched(self.ratios), self.log_forces)

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return F/E* [m²] and its partial derivatives at depths [m] and s = ``length`` [m]."""
        touching, (slope, intercept) = depth > 0, self.width
        d = np.maximum(depth[touching], 1e-60)
        u = np.log(d)
        width = np.exp(intercept + slope * u)
        x = length / width
        t = stretched(x)
        u_inside = np.clip(u, *np.log(self.depths[[0, -1]]))
        t_inside = np.minimum(t, stretched(self.ratios[-1:])[0])
        value, by_u, by_t, by_both = (
            self._spline(u_inside, t_inside, dx=dx, dy=dy, grid=False)
            for dx, dy in ((0, 0), (1, 0), (0, 1), (1, 1))
        )
        u_beyond, t_beyond = u - u_inside, t - t_inside
        force = np.exp(value + by_u * u_beyond + by_t * t_beyond + by_both * u_beyond * t_beyond)
        rate_u, rate_t = by_u + by_both * t_beyond, by_t + by_both * u_beyond
        rate_x = rate_t / (x + SCALE)
        out = np.zeros((3, depth.size))
        out[0, touching] = force
        out[1, touching] = force * (rate_u - rate_x * x * slope) / d
        out[2, touching] = force * rate_x / width
        return ForceCurve(*out)
