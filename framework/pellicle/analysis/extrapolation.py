"""What a number becomes on ever finer grids."""

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
    """At h = 0."""
    coefficient: float
    exponent: float
    lowest: float
    """Lowest limit that comes out where one of the grids is left out."""
    highest: float
    """Highest such limit."""

    def __call__(self, spacing: ArrayLike) -> Array:
        """Return the value on cells of a size."""
        return self.limit + self.coefficient * np.asarray(spacing, dtype=float) ** self.exponent


def extrapolate(spacing: ArrayLike, values: ArrayLike) -> Extrapolation:
    """Return the power law through the values that nested grids give.

    The error that comes of the cells goes with a power of their size, as Prodanov, Dapp & Müser
    (2014) take it to extrapolate the area of rough contact; here the exponent is fitted, by least
    squares, for it depends on the quantity, the surface and the kernel.

    Parameters
    ----------
    spacing
        Cell size of each grid, in any unit; at least three different ones.
    values
        The number on each grid, of the same shape.

    Returns
    -------
    All NaN where no exponent from 0.1 to 8 fits best: the values do not tend anywhere yet. The
    range of limits is NaN where that is so of the grids without one of them, or where these are
    fewer than three.

    Raises
    ------
    ValueError
        Fewer than three different spacings.
    """
    h, v = (np.asarray(each, dtype=np.float64).ravel() for each in (spacing, values))
    if np.unique(h).size < 3:
        raise ValueError(
            f"{np.unique(h).size} cell sizes do not fix a limit, a coefficient and an exponent; "
            "give at least three"
        )
    limit, coefficient, exponent = _fit(h, v)
    others = [_fit(h[h != each], v[h != each])[0] for each in np.unique(h)]
    return Extrapolation(limit, coefficient, exponent, float(np.min(others)), float(np.max(others)))


def _fit(h: Array, v: Array) -> tuple[float, float, float]:
    """Return limit, coefficient and exponent."""
    h_max, middle, spread = h.max(), v.mean(), np.ptp(v)
    if np.unique(h).size < 3:
        return nan, nan, nan
    if spread == 0:
        return float(middle), 0.0, nan
    exponent = _best(h / h_max, (v - middle) / spread)
    if exponent is None:
        return nan, nan, nan
    (limit, coefficient), _ = _line((h / h_max) ** exponent, (v - middle) / spread)
    return (
        float(middle + spread * limit),
        float(spread * coefficient / h_max**exponent),
        exponent,
    )


def _best(h: Array, v: Array) -> float | None:
    """Return the exponent of the least squares, None if it is at an end of the range."""
    from scipy.optimize import minimize_scalar

    tried = np.log(np.geomspace(*_EXPONENTS, 200))
    missed = [_line(h ** np.exp(each), v)[1] for each in tried]
    at = int(np.argmin(missed))
    if at in (0, tried.size - 1):
        return None
    found = minimize_scalar(
        lambda each: _line(h ** np.exp(each), v)[1],
        bounds=(tried[at - 1], tried[at + 1]),
        method="bounded",
        options={"xatol": 1e-12},
    )
    return float(np.exp(found.x))


def _line(x: Array, y: Array) -> tuple[Array, float]:
    """Return the intercept and the slope of least squares, and the sum of the squares left."""
    matrix = np.stack([np.ones_like(x), x], axis=1)
    fit = np.linalg.lstsq(matrix, y)[0]
    return np.asarray(fit), float(np.sum((matrix @ fit - y) ** 2))
