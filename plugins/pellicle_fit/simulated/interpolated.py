"""A force curve interpolated between simulated contacts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial.chebyshev import chebder, chebval2d, chebvander

from pellicle.arrays import Array
from pellicle.components import ForceCurve
from pellicle_axisymmetric import force_curve, punch_radius

from .equivalent import EquivalentBody

RATIOS: Array = np.array([0.05, 0.25, 1.2, 5.0, 24.0])
"""Nodes x = s/a under tension, a = ¾ F₀/δ."""
_LEAST_DEPTH = 1e-60
_TENSED = 3
"""Depths at which a tension acts as well."""


def tensed_depths(values: Array) -> Array:
    """Return those at the depths where a tension acts as well: every second of the deepest.

    At shallower ones what is left changes little, and less of the force depends on it.
    """
    return values[::-2][:_TENSED][::-1]


@dataclass(frozen=True, eq=False)
class SimulatedCurve:
    """F/E* of an indenter on a solid under tension, interpolated between simulated contacts.

    A tension acts about as on the body of revolution with the same force without tension. The
    logarithm of what is left is 0 without tension, a polynomial of log δ and of x/(1 + x).
    """

    body: EquivalentBody
    """The body, with the nodes of the depth."""
    forces: Array | None = None
    """F/E* [m²] under tension at `tensed_depths` and the nodes of x, of shape (k, n)."""
    accuracy: float = 0.0
    """Largest relative change of some forces when the cells along each axis are halved."""
    half_space: bool = True
    """Whether the solid under the skin is one."""

    @property
    def depth_limit(self) -> float:
        """Depth [m] of the deepest node."""
        return float(self.body.depths[-1])

    @cached_property
    def nodes(self) -> tuple[Array, Array, Array]:
        """Return s [m], and force over F₀ and contact radius over a₀ of the body, at `RATIOS`."""
        depths = tensed_depths(self.body.depths)
        lengths = np.outer(self.body.log_force(np.log(depths))[2], RATIOS)
        values = np.empty((2, depths.size, RATIOS.size + 1))
        for i, row in enumerate(lengths.tolist()):
            for j, s in enumerate([0.0, *row]):
                of = force_curve(self.body, depths[i : i + 1], s)
                values[:, i, j] = of.force[0], punch_radius(of.by_depth, s).radius[0]
        force, radius = values[:, :, 1:] / values[:, :, :1]
        return lengths, force, radius

    @cached_property
    def _left(self) -> Array:
        """Coefficients of what is left."""
        if self.forces is None:
            return np.zeros((2, 2))
        log_depths = np.log(tensed_depths(self.body.depths))
        expected = np.exp(self.body.log_force(log_depths)[0])[:, None] * self.nodes[1]
        left, v = np.log(self.forces / expected), RATIOS / (1 + RATIOS)
        of_depth = chebvander(self._place(log_depths)[0], len(left) - 1)
        of_ratio = v[:, None] * chebvander(2 * v - 1, v.size - 1)
        return np.asarray(np.linalg.solve(of_ratio, np.linalg.solve(of_depth, left).T).T)

    def _place(self, log_depth: Array) -> tuple[Array, Array]:
        """Return where a depth lies between the nodes, from −1 to 1, and the rate of that."""
        low, high = np.log(self.body.depths[[0, -1]])
        inside = np.clip(log_depth, low, high)
        rate = np.where(inside == log_depth, 2 / (high - low), 0.0)
        return 2 * (inside - low) / (high - low) - 1, rate

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return F/E* [m²] and its partial derivatives at depths [m] and s = ``length`` [m]."""
        touching = depth > 0
        d = np.maximum(depth[touching], _LEAST_DEPTH)
        u = np.log(d)
        log, slope, radius = self.body.log_force(u)
        bare, under = (force_curve(self.body, d, s) for s in (0.0, length))
        x, left = length / radius, self._left
        v, (z, z_rate) = x / (1 + x), self._place(u)
        value, by_z, by_v = (
            chebval2d(z, 2 * v - 1, part)
            for part in (left, chebder(left, axis=0), chebder(left, axis=1))
        )
        force = np.exp(log + v * value) * (under.force / bare.force)
        by_x = (value + 2 * v * by_v) / (1 + x) ** 2
        by_depth = slope + v * by_z * z_rate + by_x * x * (1 - slope)
        by_depth = by_depth / d + under.by_depth / under.force - bare.by_depth / bare.force
        out = np.zeros((3, depth.size))
        out[0, touching] = force
        out[1, touching] = force * by_depth
        out[2, touching] = force * (under.by_length / under.force + by_x / radius)
        return ForceCurve(*out)
