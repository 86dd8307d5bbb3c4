"""A flat punch on layers by one integral equation, from decimal arithmetic: a reference solution.

The pressure p̂(q) = 2E* ∫₀ᵃ φ(t) cos qt dt is zero outside the punch for any φ. With G = 2g/(E* q),
E* of the uppermost layer, the displacement is δ inside it if (Lebedev & Ufliand 1958)

    φ(x) + (1/π) ∫₀ᵃ φ(t) [k(x − t) + k(x + t)] dt = δ,    k(z) = ∫₀^∞ (g(q) − 1) cos qz dq,

and the force is 2E* ∫₀ᵃ φ dt. g − 1 falls as e^{−2qh}, and all functions are smooth, so that Gauss
points converge exponentially (Nyström).
"""

from collections.abc import Sequence

import numpy as np

from tests.plugins.kernels.elastic_stack import HalfSpace, Layer, stack_compliance

_PANELS, _POINTS = 14, 12


def punch_factor(layers: Sequence[Layer], substrate: HalfSpace | None, radius: float) -> float:
    """Return κ in P = 2E* a δ κ, with E* of the uppermost layer."""
    modulus = layers[0].youngs_modulus / (1 - layers[0].poissons_ratio ** 2)
    nodes, weights = np.polynomial.legendre.leggauss(_POINTS)
    # Waves from far longer than punch and layers to those that do not feel the second layer.
    lowest = 1e-4 / (radius + sum(layer.thickness for layer in layers))
    edges = np.append(0.0, np.geomspace(lowest, 20 / layers[0].thickness, _PANELS))
    half = np.diff(edges)[:, None] / 2
    q = (edges[:-1, None] + half * (nodes + 1)).ravel()
    softness = np.array([stack_compliance(layers, substrate, float(value)) for value in q])
    weighted = (half * weights).ravel() * (softness * modulus * q / 2 - 1)
    x, dx = radius * (nodes + 1) / 2, radius * weights / 2
    cosines = np.cos(np.outer(x, q))
    kernel = 2 / np.pi * (cosines * weighted) @ cosines.T
    phi = np.linalg.solve(np.eye(_POINTS) + kernel * dx, np.ones(_POINTS))
    return float(phi @ dx / radius)
