"""Panels graded towards the ends of an axisymmetric contact.

Points are t = sin ψ on [0, 1] (t in units of the contact radius).  ψ and its
complement η = π/2 − ψ are both kept, so that distances stay exact to round-off at
either end however fine the panels are there.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander

from pellicle.arrays import Array, Mask


@dataclass(frozen=True)
class Points:
    """Points t = sin ψ, any shape."""

    psi: Array
    eta: Array

    @property
    def t(self) -> Array:
        """Position in units of the contact radius."""
        return np.sin(self.psi)

    def shift(self, offset: Array) -> Points:
        """Return the points with ψ increased by an offset of broadcastable shape."""
        return Points(self.psi + offset, self.eta - offset)

    def mirrored(self) -> Points:
        """Return the points at −t."""
        return Points(-self.psi, np.pi - self.eta)

    def column(self) -> Points:
        """Return the points with one more, trailing, axis."""
        return Points(self.psi[..., None], self.eta[..., None])

    def __getitem__(self, index: slice | Mask) -> Points:
        """Return some of the points."""
        return Points(self.psi[index], self.eta[index])


def points_at(t: Array) -> Points:
    """Return the points at given positions 0 ≤ t ≤ 1."""
    cosine = np.sqrt((1 - t) * (1 + t))
    return Points(np.arctan2(t, cosine), np.arctan2(cosine, t))


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


def graded_panels(order: int, edge: float, centre: float) -> list[Panel]:
    """Return panels of ``order`` Gauss points over [0, π/2], from the axis to the edge.

    Each is half as long as its neighbour, down to ``centre`` and ``edge`` in ψ at either end.
    """
    nodes = gauss(order)[0]

    def half(finest: float) -> list[tuple[float, float]]:
        steps = max(0, int(np.ceil(np.log(finest / (np.pi / 4)) / np.log(0.5))))
        ends = [0.0] + [np.pi / 4 * 0.5**k for k in range(steps, -1, -1)]
        return list(pairwise(ends))

    panels = []
    for low, high in half(centre):
        psi = low + (high - low) * (nodes + 1) / 2
        start, end = (Points(np.asarray(x), np.asarray(np.pi / 2 - x)) for x in (low, high))
        panels.append(Panel(start, end, high - low, Points(psi, np.pi / 2 - psi)))
    for low, high in reversed(half(edge)):
        eta = high - (high - low) * (nodes + 1) / 2
        start, end = (Points(np.asarray(np.pi / 2 - x), np.asarray(x)) for x in (high, low))
        panels.append(Panel(start, end, high - low, Points(np.pi / 2 - eta, eta)))
    return panels


def all_points(panels: list[Panel]) -> Points:
    """Return the Gauss points of all panels, shape (n,)."""
    return Points(
        np.concatenate([panel.nodes.psi for panel in panels]),
        np.concatenate([panel.nodes.eta for panel in panels]),
    )
