"""Hyperbolic functions less the first terms of their series, scaled by e^{−y}.

The compliances of layers are quotients of such functions: of a thin incompressible layer nothing is
left but differences of the order y³.
"""

from __future__ import annotations

from math import factorial
from typing import Final

import numpy as np

from pellicle.arrays import Array

DEEP: Final = 100.0
"""2qh above which e^{−2qh} is below double precision and a layer acts as a half-space."""

# Below it the power series is summed; its terms reach double precision there.
_SPLIT: Final = 2.0
_TERMS: Final = 12


def scaled_sinh_rest(y: Array) -> Array:
    """Return (sinh y − y) e^{−y} for y > 0 without cancellation."""
    far = -np.expm1(-2 * y) / 2 - y * np.exp(-y)
    return np.where(y < _SPLIT, _series(y, 3), far)


def scaled_cosh_rest(y: Array) -> Array:
    """Return (cosh y − 1 − y²/2) e^{−y} for y > 0 without cancellation."""
    far = (np.expm1(-y) ** 2 - y**2 * np.exp(-y)) / 2
    return np.where(y < _SPLIT, _series(y, 4), far)


def _series(y: Array, first: int) -> Array:
    """Return (yⁿ/n! + yⁿ⁺²/(n + 2)! + …) e^{−y}, n = ``first``, with y limited to `_SPLIT`."""
    small = np.minimum(y, _SPLIT)
    series = np.zeros_like(y)
    for k in reversed(range(_TERMS)):
        series = series * small**2 + 1 / factorial(first + 2 * k)
    return small**first * series * np.exp(-small)
