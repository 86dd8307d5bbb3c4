"""Product integration of a singular kernel over graded panels."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander

from pellicle.arrays import Array

from .panels import Panel, Points, all_points, gauss

IntegralKernel = Callable[[Array, Points, Points], Array]


@lru_cache(maxsize=16)
def end_point_rule(power: int) -> tuple[Array, Array]:
    """Return a rule on (0, 1) for integrands singular at, or close to, 0.

    The substitution ξ = u^power also resolves a scale of about 10^(−power) in ξ.
    """
    nodes, unit = leggauss(8 + 6 * power)
    u = (nodes + 1) / 2
    return u**power, unit / 2 * power * u ** (power - 1)


def kernel_substitution(ratio: float) -> int:
    """Return the substitution that resolves a kernel of scale s/a = ratio in a panel."""
    return max(6, int(np.ceil(-2 * np.log10(ratio)))) if ratio else 6


def _separation(target: Points, source: Points) -> Array:
    """Return ψ_source − ψ_target without cancellation at either end."""
    near_edge = target.eta < np.pi / 4
    return np.where(near_edge, target.eta - source.eta, source.psi - target.psi)


def _chord(target: Points, source: Points, separation: Array) -> Array:
    """Return |t_source − t_target| from their separation in ψ."""
    chord: Array = np.abs(2 * np.sin((target.eta + source.eta) / 2) * np.sin(separation / 2))
    return chord


def weights(
    panel: Panel, targets: Points, kernel: IntegralKernel, above: bool = False, power: int = 6
) -> Array:
    """Return the weights of ∫ y(ψ) kernel(|t − x|, t, x) dψ over one panel, shape (m, order).

    They are those of y at the Gauss points of the panel, for targets x of shape (m,). The kernel is
    smooth except at t = x, where ``power`` is that of the substitution, see ``end_point_rule``.
    With ``above`` the integral is over t > x only.
    """
    order = panel.nodes.psi.size
    rule = gauss(order)
    length = panel.length
    column = targets.column()
    # Distances from the target to both ends, positive if the end lies beyond it.
    behind = -_separation(targets, panel.start)
    ahead = _separation(targets, panel.end)
    out = np.zeros((targets.psi.size, order))

    far = (behind <= -length) | ((ahead <= -length) & (not above))
    if np.any(far):
        targeted = column[far]
        separation = _separation(targeted, panel.nodes)
        values = kernel(_chord(targeted, panel.nodes, separation), panel.nodes, targeted)
        out[far] = values * rule[1] * length / 2

    xi, unit = end_point_rule(power)
    for side, distance, opposite, end in (
        (1.0, ahead, behind, panel.start),
        (-1.0, behind, ahead, panel.end),
    ):
        # Integrate away from the point of the panel that is nearest to the target.
        pick = ~far & (distance > 0)
        if (above and side < 0) or not np.any(pick):
            continue
        span = np.minimum(distance[pick], length)[:, None]
        offset = np.maximum(-opposite[pick], 0)[:, None] + span * xi
        targeted = column[pick]
        inside = opposite[pick][:, None] > 0
        nearest = Points(
            np.where(inside, targeted.psi, end.psi), np.where(inside, targeted.eta, end.eta)
        )
        source = nearest.shift(side * span * xi)
        values = kernel(_chord(targeted, source, offset), source, targeted)
        local = side * (1 - 2 * (distance[pick][:, None] - offset) / length)
        basis = legvander(local, order - 1) @ rule[2]
        out[pick] += np.einsum("tq,tqj->tj", values * unit * span, basis)
    return out


def collocation(panels: list[Panel], kernel: IntegralKernel, power: int, parity: int) -> Array:
    """Return the matrix (n, n) of an integral over [−1, 1], collocated at the nodes of [0, 1].

    ``parity`` is 1 if the unknown is even, −1 if it is odd.
    """
    nodes = all_points(panels)
    blocks = []
    for panel in panels:
        mirror = weights(panel.mirrored(), nodes, kernel, power=power)[:, ::-1]
        blocks.append(weights(panel, nodes, kernel, power=power) + parity * mirror)
    return np.hstack(blocks)
