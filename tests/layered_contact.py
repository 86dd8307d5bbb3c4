"""Dense solutions of the contact of a paraboloid with an elastic layer, as oracles.

The Abel transform reduces the contact to π φ(x) + ∫_{−a}^{a} φ(t) L(x − t) dt = E* (δ − x²/R),
L(z) = ∫₀^∞ cos(qz) [E* q G(q)/2 − 1] dq, P = π ∫ φ, φ(±a) = 0.  L is smooth if the kernel becomes
that of a half-space exponentially with q, so Gauss points give all digits.  The punch has 1 on the
right and releases the energy G = π φ(a)² / (2E*a) per area.
"""

from typing import NamedTuple

import numpy as np
from scipy.special import jv

from pellicle.arrays import Array
from pellicle.components import Kernel

_NODES = 40
_LONGEST, _PIECES = 40.0, 24
_FUNCTIONS, _SHORTEST = 16, 4000.0


class LayeredContact(NamedTuple):
    """Contact without adhesion, for E* = 1."""

    force: float
    """F₁."""
    depth: float
    """δ₁."""
    stiffness: float
    """k, of the flat punch of the same radius."""
    stiffness_slope: float
    """dk/da."""


def layered_contact(
    kernel: Kernel, thickness: float, contact_radius: float, radius: float = 1.0
) -> LayeredContact:
    """Return the contact of a paraboloid; the kernel has E* = 1 and the given thickness."""
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    t, w = nodes * contact_radius, weights * contact_radius
    ends = np.append(0.0, np.geomspace(0.05, _LONGEST, _PIECES)) / thickness
    halves = np.diff(ends)[:, None] / 2
    q, wq = ((ends[:-1, None] + halves * (nodes + 1)).ravel(), (halves * weights).ravel())
    excess = (q * kernel.compliance(q) / 2 - 1) * wq

    def smooth(distance: Array) -> Array:
        value: Array = np.cos(distance[..., None] * q) @ excess
        return value

    matrix = np.pi * np.eye(_NODES) + smooth(t[:, None] - t) * w
    punch, bowl = np.linalg.solve(matrix, np.stack([np.ones(_NODES), t**2 / radius], axis=1)).T
    edge = smooth(contact_radius - t) * w
    punch_edge = (1 - edge @ punch) / np.pi
    bowl_edge = (contact_radius**2 / radius - edge @ bowl) / np.pi
    depth = bowl_edge / punch_edge
    return LayeredContact(
        force=float(np.pi * (w @ (depth * punch - bowl))),
        depth=float(depth),
        stiffness=float(np.pi * (w @ punch)),
        stiffness_slope=float(2 * np.pi**2 * punch_edge**2),
    )


def tensed_layer_contact(
    kernel: Kernel, contact_radius: float = 1.0, radius: float = 1.0
) -> tuple[float, float]:
    """Return force and depth of a paraboloid on a kernel with E* = 1 under a tension s/2 ≥ a/2.

    A Galerkin solution: φ = Σ cₙ √(a² − t²) U₂ₙ(t/a), whose cosine transforms are Bessel functions
    of odd order, tested with the same functions and one more, for the unknown depth.  All integrals
    over the symbol of the kernel are sums over Gauss points; nothing is subtracted from it.  The
    relative error of the force is 1e-5 at s = a, 4e-8 at s = 10 a.
    """
    orders = 2 * np.arange(_FUNCTIONS + 1) + 1
    nodes, weights = np.polynomial.legendre.leggauss(8)
    # Panels of the symbol at long waves, then one for each unit of qa.
    ends = np.concatenate([[0.0], np.geomspace(1e-6, 1.0, 40), np.arange(2.0, _SHORTEST)])
    halves = np.diff(ends)[:, None] / 2
    q, wq = ((ends[:-1, None] + halves * (nodes + 1)).ravel(), (halves * weights).ravel())
    symbol = q * kernel.compliance(q / contact_radius) / 2 / contact_radius
    signs = (-1.0) ** np.arange(_FUNCTIONS + 1)
    transforms = np.pi * signs * orders * jv(orders, q[:, None]) / q[:, None]
    matrix = transforms.T @ (transforms * (symbol * wq)[:, None])
    # ∫ √(1 − t²) U₂ₘ is π/2 for m = 0; ∫ t² √(1 − t²) U₂ₘ is π/8 for m = 0 and 1.
    ones, squares = np.zeros((2, _FUNCTIONS + 1))
    ones[0], squares[:2] = np.pi / 2, np.pi / 8
    system = np.column_stack([matrix[:, :-1], -ones])
    *series, depth = np.linalg.solve(system, -squares)
    scale = contact_radius**2 / radius
    return float(np.pi**2 / 2 * series[0]) * scale * contact_radius, float(depth) * scale
