"""Influence function of the one-dimensional equation for a tensed half-space.

The Abel transform turns the axisymmetric compliance 2 / (E* (q + s q²)) into the
even convolution kernel K(z) = ∫₀^∞ cos(qz) / (1 + s q) dq.  With y = |z| / s it is
K = g(y) / s, where g is the auxiliary function of the sine and cosine integrals
(Abramowitz & Stegun 1964, 5.2.7 and 5.2.13).
"""

from __future__ import annotations

import numpy as np
from scipy.special import sici

from pellicle.arrays import Array

_FAR = 50.0
_TERMS = 14


def _tail(y: Array, first: int) -> Array:
    """Return Σ_k (−1)^k (2k + first)! / y^(2k) for large y by Horner's rule."""
    inverse = (1 / y) ** 2
    total = np.ones_like(y)
    for k in range(_TERMS, 0, -1):
        total = 1 - (2 * k + first) * (2 * k + first - 1) * inverse * total
    return total


def auxiliary_g(y: Array) -> Array:
    """Return g(y) = ∫₀^∞ cos(v) / (v + y) dv = −Ci(y) cos y − si(y) sin y, y > 0 of any shape.

    Ci cos and si sin cancel to 1/y² for large y (Abramowitz & Stegun 1964, 5.2.35 is used there);
    near zero g → −ln y − γ.
    """
    near = np.minimum(y, _FAR)
    sine, cosine = sici(near)
    exact = -cosine * np.cos(near) - (sine - np.pi / 2) * np.sin(near)
    far = np.maximum(y, _FAR)
    return np.where(y < _FAR, exact, (1 / far) ** 2 * _tail(far, 1))


def primitive(y: Array) -> Array:
    """Return ∫₀^y g = π/2 − f(y), f(y) = ∫₀^∞ sin(v) / (v + y) dv, for y > 0 of any shape.

    f = Ci(y) sin y − si(y) cos y (Abramowitz & Stegun 1964, 5.2.6 and 5.2.34), arranged so that
    nothing cancels for small y.
    """
    near = np.minimum(y, _FAR)
    sine, cosine = sici(near)
    exact = np.pi * np.sin(near / 2) ** 2 + sine * np.cos(near) - cosine * np.sin(near)
    far = np.maximum(y, _FAR)
    return np.where(y < _FAR, exact, np.pi / 2 - _tail(far, 0) / far)
