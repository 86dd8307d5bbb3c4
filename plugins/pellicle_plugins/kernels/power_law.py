"""A power law of relaxation as a sum of exponentials."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np

from pellicle.arrays import Array

_PER_DECADE: Final = 2
# The series begins and ends by this factor beyond the span that it fits.
_BEYOND: Final = math.sqrt(10)
_SAMPLES_PER_DECADE: Final = 40


class PronySeries(NamedTuple):
    """E(t) = constant + Σ weights e^(−t/times), in units of E at the shortest time of its span."""

    constant: float
    weights: tuple[float, ...]
    times: tuple[float, ...]
    """Relaxation times, over the shortest time of the span."""
    error: float
    """Largest relative error of E(t) within the span."""

    @property
    def total(self) -> float:
        """E(0), the stiffness before the span."""
        return math.fsum([self.constant, *self.weights])


@lru_cache(maxsize=64)
def power_law_series(exponent: float, span: float) -> PronySeries:
    """Return the series of t^(−α), 0 < α < 1, between the times 1 and ``span`` > 1.

    Two branches per decade, with weights ≥ 0 that minimise the sum of squares of the relative error
    at times spaced evenly in log t. The largest relative error, measured in between too, is 6e-5,
    1.4e-4, 6e-4, 3e-3 for α = 0.1, 0.2, 0.5, 0.99, and hardly depends on the span.
    """
    # scipy.optimize takes long to import, and only a power law needs it.
    from scipy.optimize import lsq_linear

    decades = math.log10(span)
    number = math.ceil(_PER_DECADE * (decades + 1)) + 1
    times = np.geomspace(1 / _BEYOND, span * _BEYOND, number)
    t = np.geomspace(1.0, span, math.ceil(_SAMPLES_PER_DECADE * decades) + 4 * number)
    matrix = _relative_terms(t, times, exponent)
    # Bounded least squares; nnls stops with an error if its columns are nearly dependent.
    fit = lsq_linear(matrix, np.ones(t.size), (0.0, np.inf), method="bvls", tol=1e-12)
    middle = np.sqrt(t[1:] * t[:-1])
    error = max(
        float(np.abs(matrix @ fit.x - 1).max()),
        float(np.abs(_relative_terms(middle, times, exponent) @ fit.x - 1).max()),
    )
    active = np.flatnonzero(fit.x[:-1] > 0)
    return PronySeries(
        float(fit.x[-1]), tuple(fit.x[active].tolist()), tuple(times[active].tolist()), error
    )


def _relative_terms(t: Array, times: Array, exponent: float) -> Array:
    """Return each exponential, and a constant, over t^(−α); shape (times of t, terms)."""
    terms = np.exp(-t[:, None] / times)
    columns: Array = np.column_stack([terms, np.ones(t.size)]) * t[:, None] ** exponent
    return columns
