"""Complex stiffness of a flat punch on a solid with a complex modulus, under a tension.

At a fixed contact the stiffness k(E*, τ₀) of a radius a is homogeneous of degree 1 in modulus and
tension, and that of a passive solid wherever both are (the correspondence principle). So k/2E*a is
a complete Bernstein function of x = s/a, s = 2τ₀/E*: 1 + αx + Σ cⱼx/(x + pⱼ) with α, cⱼ, pⱼ ≥ 0,
which holds for complex x as for real ones.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array

from .reciprocity import punch_stiffness

_RATIOS, _COUNT = (1e-6, 1e6), 400
"""s/a between which the function is sampled, and at how many values."""
_POLES, _POLE_COUNT, _STEPS = (1e-5, 1e7), 31, 10_000


def dynamic_punch_stiffness(
    radius: Array, modulus: NDArray[np.complex128], tension: Array | float
) -> NDArray[np.complex128]:
    """Return the stiffness k [N/m] of punches of some radii [m] on solids under a tension [N/m].

    The moduli E*(ω) [Pa] have real parts > 0; all arguments broadcast. The error is 1e-6 of |k|
    for |s|/a up to 1e6.
    """
    rate, poles, weights = _function()
    x = 2 * np.asarray(tension) / (modulus * radius)
    ratio = 1 + rate * x + np.sum(weights * x[..., None] / (x[..., None] + poles), axis=-1)
    return np.asarray(2 * modulus * radius * ratio)


@cache
def _function() -> tuple[float, Array, Array]:
    """Return α, the pⱼ and the cⱼ."""
    from scipy.optimize import nnls

    x, poles = np.geomspace(*_RATIOS, _COUNT), np.geomspace(*_POLES, _POLE_COUNT)
    ratio = np.exp(punch_stiffness(x)[0])
    # Columns of the order of 1 at their poles.
    columns = np.column_stack([x, x[:, None] * (1 + poles) / (x[:, None] + poles)])
    weights, _ = nnls(columns / ratio[:, None], (ratio - 1) / ratio, maxiter=_STEPS)
    own = weights[1:] > 0
    return float(weights[0]), poles[own], weights[1:][own] * (1 + poles[own])
