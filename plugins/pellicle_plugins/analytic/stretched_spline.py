"""Splines on a variable that is linear in x at first and logarithmic beyond a scale."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array

Interpolant = Callable[[Array], tuple[Array, Array]]
"""Values and their derivative in x ≥ 0; for x of shape (n,), those of nodes have trailing axes."""


def stretched_spline(x: ArrayLike, values: ArrayLike, scale: float) -> Interpolant:
    """Return the spline of degree 5 in t = log(1 + x/scale); linear in t beyond the last x.

    ``x`` has shape (n,) and increases, ``values`` has shape (n, …).
    """
    from scipy.interpolate import make_interp_spline

    t = np.log1p(np.asarray(x) / scale)
    spline = make_interp_spline(t, values, 5)
    slope = spline.derivative()

    def interpolant(x: Array) -> tuple[Array, Array]:
        at = np.log1p(x / scale)
        inside = np.minimum(at, t[-1])
        rate = slope(inside)
        column = (slice(None), *(None,) * (rate.ndim - 1))
        value = spline(inside) + rate * (at - inside)[column]
        return value, rate / (x + scale)[column]

    return interpolant
