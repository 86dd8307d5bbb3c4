"""The power spectrum of a surface."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
import scipy.fft
from numpy.typing import ArrayLike, NDArray

from pellicle.arrays import Array
from pellicle.grid import Grid


@dataclass(frozen=True)
class Spectrum:
    """Power spectral density over rings of wave vectors."""

    wavenumber: Array
    """Mean |q| of each ring [rad/m], increasing."""
    density: Array
    """Mean C(q) over each ring [m⁴]."""
    count: NDArray[np.int64]
    """Number of wave vectors in each ring."""
    area: float
    """Area of the domain [m²]."""

    @property
    def mean_square(self) -> float:
        """Mean square of the heights [m²], Σ count · density / area (Parseval)."""
        return float(np.sum(self.count * self.density)) / self.area


def spectrum(heights: ArrayLike, grid: Grid) -> Spectrum:
    """Return the radially averaged power spectral density of finite heights [m], shape (nx, ny).

    C(q) = |ĥ(q)|² / A with ĥ(q) = Σ h e^{−iq·x} dx dy over the domain of area A, as C^2D in Jacobs,
    Junge & Pastewka (2017). Rings are 2π/L wide, L being the longer edge of the domain. q = 0 is
    left out; the corners of the Fourier plane are included.

    On a periodic grid the heights are used unchanged. On a free one they are not continuous across
    the edge: their mean weighted by the window sin²(πx/L_x) sin²(πy/L_y) (Hann) is subtracted, they
    are multiplied by the window, and C is divided by the mean square of the window. So
    `Spectrum.mean_square` is the mean square of the heights weighted by the window's square.

    Raises
    ------
    ValueError
        A height is NaN or infinite.
    """
    h = np.asarray(heights, dtype=np.float64)
    if not np.isfinite(h).all():
        raise ValueError("the heights are not finite everywhere, so they have no spectrum")
    if grid.boundary == "free":
        window = np.outer(*(np.sin(pi * (np.arange(n) + 0.5) / n) ** 2 for n in grid.shape))
        h = (h - np.average(h, weights=window)) * window
        h /= np.sqrt(np.mean(window**2))
    density = np.abs(scipy.fft.rfft2(h) * grid.cell_area) ** 2 / grid.area
    q = np.hypot(*grid.wavenumbers())
    # rfft2 returns one of each pair ±q, but both at q_y = 0 and, for an even number of cells, in
    # the last column.
    times = np.full(q.shape, 2)
    times[:, 0] = 1
    if grid.shape[1] % 2 == 0:
        times[:, -1] = 1
    ring = np.rint(q * max(grid.size) / (2 * pi)).astype(np.int64).ravel()
    count = np.bincount(ring, times.ravel())
    count[0] = 0
    filled = count > 0

    def mean(values: Array) -> Array:
        return np.asarray(np.bincount(ring, (times * values).ravel())[filled] / count[filled])

    return Spectrum(mean(q), mean(density), count[filled].astype(np.int64), grid.area)
