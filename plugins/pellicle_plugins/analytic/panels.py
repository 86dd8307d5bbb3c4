"""Product integration on panels graded towards the ends of a contact.

Points are t = sin ψ on [0, 1] (t in units of the contact radius).  ψ and its
complement η = π/2 − ψ are both kept, so that distances stay exact to round-off at
either end however fine the panels are there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Points:
    """Points t = sin ψ, any shape."""

    psi: Array
    eta: Array

    @property
    def t(self) -> Array:
        """Position in units of the contact radius."""
        return np.sin(self.psi)

    def moved(self, offset: Array) -> Points:
        """Return the points with ψ increased by an offset of broadcastable shape."""
        return Points(self.psi + offset, self.eta - offset)

    def mirrored(self) -> Points:
        """Return the points at −t."""
        return Points(-self.psi, np.pi - self.eta)

    def column(self) -> Points:
        """Return the points with one more, trailing, axis."""
        return Points(self.psi[..., None], self.eta[..., None])

    def __getitem__(self, index: object) -> Points:
        """Return some of the points."""
        return Points(self.psi[index], self.eta[index])  # type: ignore[index]


def points_at(t: Array) -> Points:
    """Return the points at given positions 0 ≤ t ≤ 1."""
    cosine = np.sqrt((1 - t) * (1 + t))
    return Points(np.arctan2(t, cosine), np.arctan2(cosine, t))


Kernel = Callable[[Array, Points, Points], Array]


@dataclass(frozen=True)
class Panel:
    """One interval of ψ with its Gauss points."""

    start: Points
    end: Points
    length: float
    nodes: Points

    def mirrored(self) -> Panel:
        """Return the panel at −ψ; the order of its nodes is reversed."""
        return Panel(
            self.end.mirrored(), self.start.mirrored(), self.length, self.nodes.mirrored()[::-1]
        )


@lru_cache(maxsize=16)
def gauss(order: int) -> tuple[Array, Array, Array]:
    """Return Gauss–Legendre nodes and weights on [−1, 1], and nodal → Legendre."""
    nodes, weights = leggauss(order)
    degrees = np.arange(order)
    to_legendre = (legvander(nodes, order - 1) * weights[:, None]).T
    return nodes, weights, to_legendre * (degrees[:, None] + 0.5)


@lru_cache(maxsize=16)
def clustered(power: int) -> tuple[Array, Array]:
    """Return a rule on (0, 1) for integrands singular at, or close to, 0.

    The substitution ξ = u^power also resolves a scale of about 10^(−power) in ξ.
    """
    nodes, unit = leggauss(8 + 6 * power)
    u = (nodes + 1) / 2
    return u**power, unit / 2 * power * u ** (power - 1)


def graded(order: int, edge: float, centre: float, ratio: float = 0.5) -> list[Panel]:
    """Return panels over [0, π/2], from the axis to the edge.

    Parameters
    ----------
    order
        Gauss points to a panel.
    edge, centre
        Length in ψ below which panels are not divided further at either end.
    ratio
        Of the lengths of neighbouring panels.
    """
    nodes = gauss(order)[0]

    def half(finest: float) -> list[tuple[float, float]]:
        steps = max(0, int(np.ceil(np.log(finest / (np.pi / 4)) / np.log(ratio))))
        ends = [0.0] + [np.pi / 4 * ratio**k for k in range(steps, -1, -1)]
        return list(zip(ends[:-1], ends[1:], strict=True))

    panels = []
    for low, high in half(centre):
        psi = low + (high - low) * (nodes + 1) / 2
        ends = [Points(np.asarray(x), np.asarray(np.pi / 2 - x)) for x in (low, high)]
        panels.append(Panel(ends[0], ends[1], high - low, Points(psi, np.pi / 2 - psi)))
    for low, high in reversed(half(edge)):
        eta = high - (high - low) * (nodes + 1) / 2
        ends = [Points(np.asarray(np.pi / 2 - x), np.asarray(x)) for x in (high, low)]
        panels.append(Panel(ends[0], ends[1], high - low, Points(np.pi / 2 - eta, eta)))
    return panels


def _separation(target: Points, source: Points) -> Array:
    """Return ψ_source − ψ_target without cancellation at either end."""
    near_edge = target.eta < np.pi / 4
    return np.where(near_edge, target.eta - source.eta, source.psi - target.psi)


def _chord(target: Points, source: Points, separation: Array) -> Array:
    """Return |t_source − t_target| from their separation in ψ."""
    return np.abs(2 * np.sin((target.eta + source.eta) / 2) * np.sin(separation / 2))


def weights(
    panel: Panel, targets: Points, kernel: Kernel, above: bool = False, power: int = 6
) -> Array:
    """Return the weights of ∫ y(ψ) kernel(|t − x|, t, x) dψ over one panel.

    Parameters
    ----------
    panel
        Where y is known, at ``order`` Gauss points.
    targets
        Positions x, shape (m,).
    kernel
        Function of the distance |t − x| > 0, of t and of x, smooth except at t = x.
    above
        Integrate over t > x only.
    power
        Of the substitution next to the singularity, see ``clustered``.

    Returns
    -------
    array
        Weights on the nodal values of y, shape (m, order).
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
        chosen = column[far]
        separation = _separation(chosen, panel.nodes)
        values = kernel(_chord(chosen, panel.nodes, separation), panel.nodes, chosen)
        out[far] = values * rule[1] * length / 2

    xi, unit = clustered(power)
    for side, this, other, end in (
        (1.0, ahead, behind, panel.start),
        (-1.0, behind, ahead, panel.end),
    ):
        # Integrate away from the point of the panel that is nearest to the target.
        pick = ~far & (this > 0)
        if above and side < 0 or not np.any(pick):
            continue
        span = np.minimum(this[pick], length)[:, None]
        offset = np.maximum(-other[pick], 0)[:, None] + span * xi
        chosen = column[pick]
        inside = other[pick][:, None] > 0
        nearest = Points(
            np.where(inside, chosen.psi, end.psi), np.where(inside, chosen.eta, end.eta)
        )
        source = nearest.moved(side * span * xi)
        values = kernel(_chord(chosen, source, offset), source, chosen)
        local = side * (1 - 2 * (this[pick][:, None] - offset) / length)
        basis = legvander(local, order - 1) @ rule[2]
        out[pick] += np.einsum("tq,tqj->tj", values * unit * span, basis)
    return out


def clustering(ratio: float) -> int:
    """Return the substitution that resolves a kernel of scale s/a = ratio in a panel."""
    return max(6, int(np.ceil(-2 * np.log10(ratio)))) if ratio else 6


def joined(panels: list[Panel]) -> Points:
    """Return the Gauss points of all panels, shape (n,)."""
    return Points(
        np.concatenate([panel.nodes.psi for panel in panels]),
        np.concatenate([panel.nodes.eta for panel in panels]),
    )


def collocation(panels: list[Panel], kernel: Kernel, power: int, parity: int) -> Array:
    """Return the matrix (n, n) of an integral over [−1, 1], collocated at the nodes.

    Parameters
    ----------
    panels
        Of [0, 1].
    kernel, power
        See ``weights``.
    parity
        1 if the unknown is even, −1 if it is odd.
    """
    nodes = joined(panels)
    blocks = []
    for panel in panels:
        mirror = weights(panel.mirrored(), nodes, kernel, power=power)[:, ::-1]
        blocks.append(weights(panel, nodes, kernel, power=power) + parity * mirror)
    return np.hstack(blocks)
