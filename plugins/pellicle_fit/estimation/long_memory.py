"""Noise whose power falls as f^(−2d), such as 1/f, and differences that make it independent."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len
from scipy.optimize import minimize_scalar
from scipy.special import chdtrc

from pellicle.arrays import Array

_FEWEST = 60
"""Least number of rows from which an exponent is estimated."""
_LEAST, _MOST = 0.1, 0.95
"""Exponents d that count: below, noise is nearly independent; 1/f noise has 1/2."""
_LAGS = 24
"""Lags over which differences have to be independent."""
_CHANCE = 3e-3
"""Probability that independent differences are taken for dependent ones."""


def fractional_differences(rows: Array, exponent: float) -> Array:
    """Return the fractional differences (1 − B)^d along the first axis, of the same shape.

    Of noise whose power falls as f^(−2d) they are independent (Granger & Joyeux 1980; Hosking
    1981).  Before the first row they assume 0.
    """
    length = next_fast_len(2 * len(rows), real=True)
    spectrum = np.fft.rfft(rows, length, axis=0)
    shape = (-1, *(1,) * (rows.ndim - 1))
    weights = _weights(length, exponent).reshape(shape)
    return np.fft.irfft(spectrum * weights, length, axis=0)[: len(rows)]


@lru_cache(maxsize=8)
def _weights(length: int, exponent: float) -> NDArray[np.complex128]:
    """Return the transform of the coefficients of (1 − B)^d for half of a length, padded to it."""
    lags = np.arange(1, length // 2)
    coefficients = np.cumprod(np.concatenate([[1.0], (lags - 1 - exponent) / lags]))
    return np.fft.rfft(coefficients, length)


def exponent_of(force: Array) -> float:
    """Return the exponent d at which the differences of noise [N] are smallest; 0 if none fits.

    The least sum of squares is the conditional maximum of the likelihood.  Smoothed noise or hum
    leave differences that depend on each other (test of Ljung & Box 1978), and 0 is returned.
    """
    size = force.size
    if size < _FEWEST:
        return 0.0
    values = force - np.mean(force)

    def misfit(exponent: float) -> float:
        return float(np.sum(fractional_differences(values, exponent) ** 2))

    exponent = float(minimize_scalar(misfit, bounds=(0.0, _MOST), method="bounded").x)
    rest = fractional_differences(values, exponent)
    variance = float(rest @ rest)
    if exponent < _LEAST or not variance:
        return 0.0
    correlations = np.array([rest[lag:] @ rest[:-lag] for lag in range(1, _LAGS + 1)]) / variance
    excess = size * (size + 2) * np.sum(correlations**2 / (size - np.arange(1, _LAGS + 1)))
    return exponent if chdtrc(_LAGS - 1, float(excess)) >= _CHANCE else 0.0
