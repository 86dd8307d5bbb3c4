"""Exact surfaces under round loads on any isotropic kernel, as Hankel integrals.

A load is a sum of even pressures p on discs of radius a about one centre, so a ring of some width
is two of them. Its transform is P(q) = Σ p a J₁(qa)/q, and

    u(r) = ∫₀^∞ G(q) P(q) J₀(qr) q dq,  ∫_{r<R} u dA = 2πR ∫₀^∞ G P J₁(qR) dq,
    ½ ∫ p u dA = π ∫₀^∞ G P² q dq.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil, pi

import numpy as np

from pellicle.arrays import Array

Compliance = Callable[[Array], Array]
Discs = Sequence[tuple[float, float]]
"""Radius [m] and pressure [Pa] of each disc."""
# An integrand that oscillates at a rate k or faster is cut off smoothly around `_END`/k, over
# `_WIDTH`/k: what that leaves out is below 1e-11 of it.
_END, _WIDTH = 60.0, 10.0
# Where it also has a part that does not oscillate, the cut-off over the radius.
_FAR = 1e5
_NODES = np.polynomial.legendre.leggauss(12)


def droplet(radius: float, vertical_tension: float, width: float) -> Discs:
    """Return a contact line that pulls by γ sin θ [N/m], and the pressure that balances it."""
    inner, outer = radius - width / 2, radius + width / 2
    pull = -2 * radius * vertical_tension / (outer**2 - inner**2)
    return (outer, pull), (inner, -pull), (radius, 2 * vertical_tension / radius)


def displacement(compliance: Compliance, discs: Discs, r: float) -> float:
    """Return u(r) [m], positive into the solid, off the edges of the discs."""
    from scipy.special import j0

    slowest = min(abs(r - a) for a, _ in discs)
    fastest = r + max(a for a, _ in discs)
    return _integral(
        lambda q: compliance(q) * _transform(discs, q) * j0(q * r), _END / slowest, fastest
    )


def volume_within(compliance: Compliance, discs: Discs, radius: float) -> float:
    """Return ∫ u dA within a circle [m³]."""
    from scipy.special import j1

    fastest = radius + max(a for a, _ in discs)
    within = _integral(
        lambda q: compliance(q) * _transform(discs, q) * j1(q * radius) / q, _FAR / radius, fastest
    )
    return 2 * pi * radius * within


def energy(compliance: Compliance, discs: Discs) -> float:
    """Return the elastic energy [J]."""
    largest = max(a for a, _ in discs)
    return pi * _integral(
        lambda q: compliance(q) * _transform(discs, q) ** 2 / q, _FAR / largest, 2 * largest
    )


def _transform(discs: Discs, q: Array) -> Array:
    """Return q P(q)."""
    from scipy.special import j1

    return np.asarray(sum(p * a * j1(q * a) for a, p in discs))


def _integral(function: Callable[[Array], Array], end: float, fastest: float) -> float:
    """Return ∫₀^∞ of a function that oscillates at a rate ``fastest`` at most, cut off smoothly."""
    from scipy.special import erfc

    edges = np.linspace(0.0, 2 * end, 50 + ceil(2 * end * fastest))
    half = 0.5 * (edges[1] - edges[0])
    q = edges[:-1, None] + half * (1 + _NODES[0])
    values = function(q) * 0.5 * erfc((q - end) * _END / _WIDTH / end)
    return float(half * (values @ _NODES[1]).sum())
