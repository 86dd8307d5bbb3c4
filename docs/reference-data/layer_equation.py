"""The axisymmetric equation of a layer bonded to a rigid base, under surface tension.

A layer of thickness h has the compliance 2 L(qh) / (E* q (1 + s q L(qh))), s = 2τ₀/E*, where L is
the ratio of its compliance without tension (Hayes et al. 1972) to that of a half-space.  So its
equation is that of ``pellicle_axisymmetric.equation`` or, for a flat punch, ``reciprocity``, with a
smooth part of the kernel more, whose transform

    L/(1 + s q L) − 1/(1 + s q) = (L − 1) / ((1 + s q L)(1 + s q))

falls with q as (qh)² e^{−2qh}.  Gauss points in q are enough for it, and the nodes of the unknown.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss

from pellicle import kernel
from pellicle.arrays import Array
from pellicle_axisymmetric.equation import LEVELS, influence
from pellicle_axisymmetric.layer_curves import Shape
from pellicle_axisymmetric.panels import Panel, Points, all_points, gauss, graded_panels, points_at
from pellicle_axisymmetric.product_integration import collocation, kernel_substitution, weights
from pellicle_axisymmetric.tension_kernel import primitive

_ENDS = np.concatenate([[0.0], np.geomspace(1e-5, 0.5, 12), np.arange(1.0, 15.0)])
"""Ends of intervals of qh; beyond the last the layer is a half-space to 1e-10."""
_ORDER = 16
_PANELS = 4.0
"""Panels of the unknown per radian, for contacts up to ten times as wide as the layer is thick."""


class Moments(NamedTuple):
    """Force and depth of contacts without adhesion, each of the shape of the profiles."""

    force: Array
    """P / (E* a²); of a punch at the depth a."""
    depth: Array
    """δ / a."""


@dataclass(frozen=True)
class HalfSpace:
    """The discrete equation of a half-space at one s/a, to which a layer adds its smooth part."""

    shape: Shape
    ratio: float
    """s/a."""
    nodes: Points
    measure: Array
    """Weights of the integral of the unknown over the contact, of shape (n,)."""
    matrix: Array
    """Of shape (n, n)."""
    reach: Array
    """Weights of δ/a, of shape (n,)."""


def half_space(shape: Shape, ratio: float, level: int = 0) -> HalfSpace:
    """Return the equation at s/a = ratio, 0 included, on a mesh level."""
    order, finest = LEVELS[level]
    edge = min(1.0, ratio) if ratio else 1.0
    pointed = shape == "pointed"
    coarse = graded_panels(
        order, finest * np.sqrt(edge), finest * edge if pointed and ratio else 1.0
    )
    panels = [part for panel in coarse for part in _split(panel, 1 / _PANELS)]
    nodes = all_points(panels)
    power = {"smooth": 1, "pointed": -1 if ratio else 0, "punch": 0}[shape]
    halves = np.repeat([panel.length / 2 for panel in panels], order)
    measure = halves * np.tile(gauss(order)[1], len(panels)) * nodes.t ** float(power)
    if not ratio:
        matrix = np.diag(np.pi * nodes.t**power / np.sin(nodes.eta))
        return HalfSpace(shape, ratio, nodes, measure, matrix, np.pi * measure)

    def depth(distance: Array, source: Points, _target: Points) -> Array:
        return 2 * source.t**power * primitive(distance / ratio)

    cluster, parity = kernel_substitution(ratio), 1 if shape == "punch" else -1
    origin = points_at(np.zeros(1))
    reach = np.concatenate([weights(panel, origin, depth, power=cluster)[0] for panel in panels])
    matrix = collocation(panels, influence(ratio, power), cluster, parity)
    return HalfSpace(shape, ratio, nodes, measure, matrix, reach)


def moments(equation: HalfSpace, slopes: Array, confinement: float, ratio: float) -> Moments:
    """Return force and depth on a layer of a/h = ``confinement``, 0 for a half-space.

    ``equation`` is that of the half-space, ``slopes`` h′ at its nodes, of shape (n, profiles), or
    δ/a of a punch, and ``ratio`` Poisson's.
    """
    t, measure, is_punch = equation.nodes.t, equation.measure, equation.shape == "punch"
    matrix, reach = equation.matrix, equation.reach
    if confinement:
        # The smooth part of the kernel, at Gauss points q a.
        x, excess, weight = _compliance(ratio)
        q, length = confinement * x, equation.ratio
        below = (1 + length * q * (1 + excess)) * (1 + length * q)
        transform = excess / below * weight * confinement
        waves = np.cos(t[:, None] * q) if is_punch else np.sin(t[:, None] * q)
        part = (waves * (2 * transform)) @ waves.T
        matrix = matrix + part * measure
        reach = reach + measure * (waves @ (2 * transform / q))
    unknown = np.linalg.solve(matrix, slopes)
    if is_punch:
        return Moments(2 * np.pi * (measure @ unknown), slopes[0])
    return Moments(2 * np.pi * ((measure * t) @ unknown), reach @ unknown)


@lru_cache(maxsize=64)
def _compliance(poissons_ratio: float) -> tuple[Array, Array, Array]:
    """Return Gauss points x = qh, L(x) − 1 and the weights."""
    nodes, unit = leggauss(_ORDER)
    halves = np.diff(_ENDS)[:, None] / 2
    x, weight = (_ENDS[:-1, None] + halves * (nodes + 1)).ravel(), (halves * unit).ravel()
    layer = kernel(
        "bonded_layer", reduced_modulus=1.0, poissons_ratio=poissons_ratio, thickness=1.0
    )
    return x, x * layer.compliance(x) / 2 - 1, weight


def _split(panel: Panel, longest: float) -> list[Panel]:
    """Return equal parts of a panel that are not longer than ``longest``."""
    count = int(np.ceil(panel.length / longest))
    if count == 1:
        return [panel]
    length = panel.length / count
    offset = length * (gauss(panel.nodes.psi.size)[0] + 1) / 2
    starts = [panel.start.shift(np.asarray(index * length)) for index in range(count)]
    return [
        Panel(start, start.shift(np.asarray(length)), length, start.shift(offset))
        for start in starts
    ]
