"""Tables, and splines on a variable that is linear in x at first, logarithmic beyond a scale."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import factorial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

Interpolant = Callable[[Array], tuple[Array, Array]]
"""Values and their derivative in x ≥ 0; for x of shape (n,), those of nodes have trailing axes."""


@cache
def table_in(file: Path) -> dict[str, Array]:
    """Return the arrays of a file of the package by name."""
    with np.load(file) as table:
        return {name: np.asarray(table[name], dtype=np.float64) for name in table.files}


def stretched_spline(x: ArrayLike, values: ArrayLike, scale: float) -> Interpolant:
    """Return the spline of degree 5 in t = log(1 + x/scale); linear in t beyond the last x.

    ``x`` has shape (n,) and increases, ``values`` has shape (n, …).
    """
    t = np.log1p(np.asarray(x) / scale)
    spline = with_slopes(t, np.stack([values], axis=1))

    def interpolant(x: Array) -> tuple[Array, Array]:
        at = np.log1p(x / scale)
        inside = np.minimum(at, t[-1])
        both = spline(inside)
        value, rate = both[:, 0], both[:, 1]
        column = (slice(None), *(None,) * (rate.ndim - 1))
        return value + rate * (at - inside)[column], rate / (x + scale)[column]

    return interpolant


def with_slopes(t: ArrayLike, values: ArrayLike) -> PPoly:
    """Return the spline of degree 5 through ``values`` of shape (n, m, …), and its slopes.

    Its values have shape (n, 2 m, …), the slopes last. One evaluation of polynomials takes half
    the time of two of B-splines.
    """
    from scipy.interpolate import PPoly, make_interp_spline

    spline = make_interp_spline(t, values, 5)
    breaks = np.unique(spline.t)
    # A derivative of order n is n! times the coefficient of that power.
    powers = [spline(breaks[:-1], order) / factorial(order) for order in range(6)]
    slopes = [order * power for order, power in enumerate(powers)][1:]
    both = [
        np.concatenate(pair, axis=1) for pair in zip(powers, [*slopes, 0 * slopes[0]], strict=True)
    ]
    return PPoly(np.array(both[::-1]), breaks)
