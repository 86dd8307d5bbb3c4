"""A force curve interpolated between simulated contacts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.interpolate import RectBivariateSpline

from pellicle.arrays import Array
from pellicle.components import Component, ForceCurve, HasForceCurve, Indenter

SCALE = 0.1
"""Of s over the width of the contact: where the nodes turn from even to logarithmic spacing."""


def stretched(x: Array) -> Array:
    """Return log(1 + x/SCALE), in which log P is smooth from no tension to nothing but tension."""
    return np.log1p(x / SCALE)


@dataclass(frozen=True)
class SimulatedCurve:
    """P/E* of an indenter on a solid under tension, between the nodes of a study.

    log(P/E*) is a cubic spline of log δ and of `stretched` s/w, where w(δ) is about the width of
    the contact; beyond the nodes it goes on straight.  With lengths in a unit of the problem's own
    the table holds for every size; `unit` is what the unit is here.
    """

    indenter: Indenter
    kernel: Mapping[str, Any]
    """The solid: table of a kernel without modulus and tension."""
    depths: Array
    """Nodes δ over the unit, rising, of shape (m,)."""
    ratios: Array
    """Nodes s/w, rising from 0, of shape (n,)."""
    log_forces: Array
    """log(P/E*) over the unit squared, of shape (m, n)."""
    width: tuple[float, float]
    """Slope and value at δ = 1 of log w over log δ."""
    unit: float
    """[m]"""
    coarse: SimulatedCurve | None = None
    """The same from grids of half as many cells each way."""

    @property
    def depth_limit(self) -> float:
        """Deepest node [m]."""
        return float(self.depths[-1]) * self.unit

    @property
    def accuracy(self) -> float:
        """The largest relative change of a force from half as many cells each way."""
        if self.coarse is None:
            return 0.0
        return float(np.max(np.abs(np.expm1(self.coarse.log_forces - self.log_forces))))

    @cached_property
    def _spline(self) -> RectBivariateSpline:
        return RectBivariateSpline(np.log(self.depths), stretched(self.ratios), self.log_forces)

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return P/E* and its sensitivities; 0 where there is no contact."""
        touching = depth > 0
        d = np.maximum(depth[touching] / self.unit, 1e-60)
        slope, intercept = self.width
        log_depth = np.log(d)
        width = np.exp(intercept + slope * log_depth)
        x = length / self.unit / width
        t = stretched(x)
        first, last = np.log(self.depths[[0, -1]])
        at_u = np.clip(log_depth, first, last)
        at_t = np.minimum(t, stretched(self.ratios[-1:])[0])
        value, by_u, by_t, by_both = (
            self._spline(at_u, at_t, dx=dx, dy=dy, grid=False)
            for dx, dy in ((0, 0), (1, 0), (0, 1), (1, 1))
        )
        u_left, t_left = log_depth - at_u, t - at_t
        force = np.exp(value + by_u * u_left + by_t * t_left + by_both * u_left * t_left)
        rate_u, rate_t = by_u + by_both * t_left, by_t + by_both * u_left
        rate_x = rate_t / (x + SCALE)
        out = np.zeros((3, depth.size))
        out[0, touching] = force * self.unit**2
        out[1, touching] = force * (rate_u - rate_x * x * slope) / d * self.unit
        out[2, touching] = force * rate_x / width * self.unit
        return ForceCurve(*out)


def described(curve: HasForceCurve) -> dict[str, Any]:
    """Return indenter and, if it was simulated, kernel of a force curve, as JSON has them."""
    if isinstance(curve, SimulatedCurve):
        said = {"kernel": dict(curve.kernel), "accuracy": curve.accuracy}
        return {"indenter": curve.indenter.model_dump(mode="json", exclude_none=True), **said}
    if isinstance(curve, Component):
        return {"indenter": curve.model_dump(mode="json", exclude_none=True)}
    return {"indenter": {"type": type(curve).__name__}}
