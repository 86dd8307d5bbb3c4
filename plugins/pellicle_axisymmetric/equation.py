"""The one-dimensional equation of axisymmetric contact under surface tension.

The Abel transform reduces the contact to ∫_{−a}^{a} φ(t) K(x − t) dt = E* (δ − h(x)),
K(z) = ∫₀^∞ cos(qz) / (1 + s q) dq, s = 2τ₀/E*, with P = π ∫ φ and φ(±a) = 0 (after Kim &
Gouldstone 2008 and Long et al. 2017).  Here h is not the profile f but, as in
``HasAbelSlope``, h(x) = −x ∫₀^x f'(r) / sqrt(x² − r²) dr.  The derivative of the
equation in x, with χ = −φ', does not contain the depth:

    ∫₀^a χ(t) [K(x − t) − K(x + t)] dt = E* h'(x),

and its only solution, proportional to (a − t)^(−1/2) at the edge, satisfies φ(±a) = 0.
Then P = 2π ∫ t χ dt, p(r) = ∫_r^a χ / sqrt(t² − r²) dt, and δ follows from the
first equation at x = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pellicle.arrays import Array
from pellicle.components import HasAbelSlope
from pellicle.errors import ConfigError, excerpt

from .panels import Panel, Points, all_points, graded_panels, points_at
from .product_integration import IntegralKernel, collocation, kernel_substitution, weights
from .tension_kernel import auxiliary_g, primitive

LEVELS = ((12, 1e-3), (16, 3e-4), (22, 1e-4))
"""Gauss points per panel, and size of the finest panel over that of the edge layer."""
_NEGLIGIBLE = 1e-12
"""s/a below which tension is neglected, which changes force and depth by less than 1e-11."""
_CHUNK = 2048
"""Positions at which the pressure is computed at once, to bound the memory."""


@dataclass(frozen=True)
class PanelSolution:
    """χ dt = E* y(ψ) t^power dψ at the nodes of the panels, t = sin ψ in units of a."""

    panels: list[Panel]
    y: Array
    power: int
    ratio: float
    """s/a; 0 without tension."""

    def moments(self) -> tuple[float, float]:
        """Return P / (E* a²) and δ / a."""
        origin = points_at(np.zeros(1))

        def load(_distance: Array, source: Points, _target: Points) -> Array:
            return 2 * np.pi * source.t ** (self.power + 1)

        def depth(distance: Array, source: Points, _target: Points) -> Array:
            reach = primitive(distance / self.ratio) if self.ratio else np.pi / 2
            return 2 * source.t**self.power * reach

        cluster = kernel_substitution(self.ratio)
        force = delta = 0.0
        for panel, y in zip(self.panels, self.y, strict=True):
            force += float(weights(panel, origin, load)[0] @ y)
            delta += float(weights(panel, origin, depth, power=cluster)[0] @ y)
        return force, delta

    def pressure(self, t: Array) -> Array:
        """Return p / E* at positions 0 ≤ t ≤ 1, but t > 0 under a pointed indenter, shape (m,)."""
        inside = points_at(t)
        # The limit from inside is taken: at η = 0 the interval of integration would be empty.
        targets = Points(inside.psi, np.maximum(inside.eta, 1e-100))

        def abel(distance: Array, source: Points, _target: Points) -> Array:
            return source.t**self.power / np.sqrt(distance * (2 * source.t - distance))

        out = np.zeros(t.shape)
        for first in range(0, t.size, _CHUNK):
            part = slice(first, first + _CHUNK)
            for panel, y in zip(self.panels, self.y, strict=True):
                out[part] += weights(panel, targets[part], abel, above=True) @ y
        return out


def solve(indenter: HasAbelSlope, a: float, ratio: float, level: int) -> PanelSolution:
    """Solve for a contact radius a [m], s/a = ratio (zero included), on a mesh level."""
    order, finest = LEVELS[level]
    # At a smooth apex χ ~ t; at a corner χ ~ 1/t under tension and is finite without.
    corner = -1 if ratio else 0
    power = corner if indenter.pointed else 1
    # At the edge 1 − t ≈ η²/2, so that a layer s/a wide in t is √(2s/a) wide in η.
    layer = min(1.0, ratio) if ratio else 1.0
    panels = graded_panels(
        order, finest * np.sqrt(layer), finest * layer if indenter.pointed else 1.0
    )
    nodes = all_points(panels)
    slope = indenter.abel_slope(a * nodes.t)
    if not ratio:
        # K is then π times the delta function, so that χ = E* h'/π; and dt = sin η dψ.
        y: Array = slope / np.pi * np.sin(nodes.eta) / nodes.t**power
    else:
        matrix = collocation(panels, influence(ratio, power), kernel_substitution(ratio), parity=-1)
        y = np.asarray(np.linalg.solve(matrix, slope), dtype=np.float64)
    return PanelSolution(panels, y.reshape(len(panels), order), power, ratio)


def influence(ratio: float, power: int) -> IntegralKernel:
    """Return the kernel K(x − t) of the equation at s/a = ratio, times t^power."""

    def kernel(distance: Array, source: Points, target: Points) -> Array:
        value = auxiliary_g(distance / ratio)
        if power < 0:
            # This term cancels between a panel and its mirror image; without it, the integral
            # over each would diverge at the apex.
            value = value - auxiliary_g(target.t / ratio)
        weighted: Array = value / ratio * np.abs(source.t) ** power
        return weighted

    return kernel


def without_negligible(ratio: float) -> float:
    """Return s/a, or exactly 0 if tension is negligible."""
    return ratio if ratio > _NEGLIGIBLE else 0.0


def kinks_of(indenter: HasAbelSlope) -> tuple[float, ...]:
    """Return the radii [m], in order, at which slope or curvature of a profile jumps."""
    return getattr(indenter, "kinks", ())


def without_kinks(indenter: HasAbelSlope) -> None:
    """Raise a ConfigError if a profile has kinks, which the panels do not resolve."""
    if kinks := kinks_of(indenter):
        raise ConfigError(
            f"has an edge at {excerpt(kinks[0])} m; only its force_curve is known", "indenter"
        )
