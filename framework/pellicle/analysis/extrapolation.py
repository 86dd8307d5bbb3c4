"""Extrapolation of a quantity to vanishing cell size."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array

_EXPONENTS = 0.1, 8.0


@dataclass(frozen=True)
class Extrapolation:
    """value(h) = limit + coefficient · h^exponent over the cell size h."""

    limit: float
    """The value at h = 0."""
    coefficient: float
    exponent: float
    lowest: float
    """Lowest of the limits obtained by leaving out one cell size."""
    highest: float
    """Highest of these limits."""

    def __call__(self, spacing: ArrayLike) -> Array:
        """Return the fitted value for a cell size."""
        return self.limit + self.coefficient * np.asarray(spacing, dtype=float) ** self.exponent


def extrapolate(spacing: ArrayLike, values: ArrayLike) -> Extrapolation:
    """Return the power law fitted to values on grids of different cell size.

    The discretisation error is assumed to be a power of the cell size, as in the extrapolation of
    rough contact area by Prodanov, Dapp & Müser (2014). The exponent is fitted, too, by least
    squares: it depends on the quantity, the surface and the kernel.

    ``spacing`` has the cell size of each grid, in any unit, and ``values`` the quantity on it. All
    is NaN if no exponent between 0.1 and 8 fits best: the values do not converge yet. The range of
    limits is NaN if that holds without one of the grids, or if fewer than three cell sizes remain.

    Raises
    ------
    ValueError
        Fewer than three different spacings.
    """
    h, v = (np.asarray(array, dtype=np.float64).ravel() for array in (spacing, values))
    if np.unique(h).size < 3:
        raise ValueError(
            f"{np.unique(h).size} cell sizes do not fix a limit, a coefficient and an exponent; "
            "give at least three"
        )
    limit, coefficient, exponent = _fit(h, v)
    others = [_fit(h[h != size], v[h != size])[0] for size in np.unique(h)]
    return Extrapolation(limit, coefficient, exponent, float(np.min(others)), float(np.max(others)))


def _fit(h: Array, v: Array) -> tuple[float, float, float]:
    """Return limit, coefficient and exponent; NaN if no exponent in the range fits best."""
    from scipy.optimize import minimize_scalar

    h_max, middle, spread = h.max(), v.mean(), np.ptp(v)
    if np.unique(h).size < 3:
        return nan, nan, nan
    if spread == 0:
        return float(middle), 0.0, nan
    h, v = h / h_max, (v - middle) / spread

    def squares(log_exponent: float) -> float:
        return _line(h ** np.exp(log_exponent), v)[1]

    trials = np.log(np.geomspace(*_EXPONENTS, 200))
    best = int(np.argmin([squares(trial) for trial in trials]))
    if best in (0, trials.size - 1):
        return nan, nan, nan
    bounds = trials[best - 1], trials[best + 1]
    result = minimize_scalar(squares, bounds=bounds, method="bounded", options={"xatol": 1e-12})
    exponent = float(np.exp(result.x))
    (limit, coefficient), _ = _line(h**exponent, v)
    return float(middle + spread * limit), float(spread * coefficient / h_max**exponent), exponent


def _line(x: Array, y: Array) -> tuple[Array, float]:
    """Return intercept and slope of the least-squares line, and the remaining sum of squares."""
    matrix = np.stack([np.ones_like(x), x], axis=1)
    fit = np.linalg.lstsq(matrix, y)[0]
    return np.asarray(fit), float(np.sum((matrix @ fit - y) ** 2))
