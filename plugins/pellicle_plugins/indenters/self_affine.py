"""The self-affine random rough surface."""

from __future__ import annotations

from math import ceil, pi
from typing import Annotated, ClassVar, Literal, NamedTuple, Self

import numpy as np
import scipy.fft
from numpy.typing import NDArray
from pydantic import Field, model_validator

from pellicle.arrays import Array
from pellicle.components import Footprint, Indenter, Lattice
from pellicle.errors import ConfigError
from pellicle.units import Length, Quantity, readable

from .sampling import UniformAxis

_ROUNDING = 1e-9
"""Relative margin of the wavelength limits, which includes waves that fit the domain exactly."""


class SelfAffine(Indenter):
    """Self-affine rough punch with random phases; it ends at the edge of the domain.

    The heights are a Fourier series fixed by the seed and the spectrum alone, so a finer grid
    samples the same surface: C(q) = C₀ q^{−2(H+1)} for q₀ ≤ q ≤ q_s and 0 elsewhere (Yuan & Wang
    2020, eq. 12), q₀ = 2π/roll_off_wavelength, q_s = 2π/cutoff_wavelength.
    """

    footprint: ClassVar[Footprint] = "domain"
    type: Literal["self_affine"] = "self_affine"
    examples = ({"rms_height": "10 um", "hurst": 0.7, "cutoff_wavelength": "0.4 mm", "seed": 3},)
    rms_height: Length = Field(description="root mean square of the heights [m]")
    hurst: Annotated[float, Quantity("1", at_least=0, at_most=1)] = Field(
        title="Hurst exponent", description="Hurst exponent H"
    )
    cutoff_wavelength: Length = Field(
        title="cut-off wavelength",
        description="shortest wavelength 2π/q_s [m]",
        json_schema_extra={"role": "shortest wave"},
    )
    roll_off_wavelength: Length | None = Field(
        None,
        title="roll-off wavelength",
        description="longest wavelength 2π/q₀ [m]; the longer edge of the domain if absent",
    )
    seed: int = Field(
        0, ge=0, description="seed of the random phases", json_schema_extra={"role": "seed"}
    )

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.roll_off_wavelength and self.roll_off_wavelength < self.cutoff_wavelength:
            raise ConfigError(
                f"{readable(self.roll_off_wavelength, 'm')} is shorter than cutoff_wavelength = "
                f"{readable(self.cutoff_wavelength, 'm')}; give a longer one",
                "roll_off_wavelength",
            )
        return self

    def profile(self, x: Array, y: Array) -> Array:
        """Return heights minus their maximum [m]; ``x`` and ``y`` span one whole period."""
        axes = UniformAxis.of(x.ravel()), UniformAxis.of(y.ravel())
        coarsest = max(axis.spacing for axis in axes)
        if 2 * coarsest >= self.cutoff_wavelength * (1 - _ROUNDING):
            raise ConfigError(
                f"{readable(self.cutoff_wavelength, 'm')} cannot be resolved by cells of "
                f"{readable(coarsest, 'm', 4)}; use more grid.points, or a cut-off above two cells",
                "cutoff_wavelength",
            )
        series = self._series(axes[0].period, axes[1].period)
        return _sample(series, *axes) - _maximum(series, *axes)

    def repeated(self, x: Array, y: Array, lattice: Lattice | None) -> Array:
        """Return the profile [m]: the series is known between the cells, so any shift is exact."""
        return self.profile(x, y)

    def _series(self, period_x: float, period_y: float) -> _Series:
        """Return the Fourier modes, one of each pair ±q of wave vectors."""
        longest = self.roll_off_wavelength or max(period_x, period_y)
        q_low = 2 * pi / longest * (1 - _ROUNDING)
        q_high = 2 * pi / self.cutoff_wavelength * (1 + _ROUNDING)
        reach = [ceil(period / self.cutoff_wavelength) + 1 for period in (period_x, period_y)]
        m, n = np.meshgrid(
            np.arange(-reach[0], reach[0] + 1), np.arange(reach[1] + 1), indexing="ij"
        )
        q = np.hypot(2 * pi / period_x * m, 2 * pi / period_y * n)
        # A real surface has conjugate coefficients at −q.
        in_range = (q >= q_low) & (q <= q_high) & ((n > 0) | (m > 0))
        if not in_range.any():
            raise ConfigError(
                f"no wavelength between {readable(self.cutoff_wavelength, 'm')} and "
                f"{readable(longest, 'm', 4)} fits the domain of {readable(period_x, 'm')} × "
                f"{readable(period_y, 'm')}; widen the range or the domain",
                "roll_off_wavelength",
            )
        m, n, q = m[in_range], n[in_range], q[in_range]
        amplitude = q ** -(self.hurst + 1)
        amplitude *= self.rms_height / np.sqrt(2 * np.sum(amplitude**2))
        return _Series(m, n, amplitude * np.exp(1j * _phases(m, n, self.seed)))


class _Series(NamedTuple):
    """h(x, y) = 2 Re Σ c exp(2πi(m x/L_x + n y/L_y)), n ≥ 0."""

    m: NDArray[np.int64]
    n: NDArray[np.int64]
    c: NDArray[np.complex128]


def _phases(m: NDArray[np.int64], n: NDArray[np.int64], seed: int) -> Array:
    """Return the random phase of each mode (m, n ≥ 0), which depends on m, n and the seed only.

    Random numbers are assigned along squares |m| ≤ s, n ≤ s of growing s, so that neither the
    limits of the spectrum nor the rounding of wave numbers changes the phase of a mode.
    """
    square = np.maximum(np.abs(m), n)
    index = square * (2 * square - 1) + np.where(n < square, 2 * n + (m > 0), 3 * square + m)
    drawn: Array = np.random.default_rng(seed).uniform(0, 2 * pi, int(index.max()) + 1)
    return np.asarray(drawn[index])


def _sample(series: _Series, x: UniformAxis, y: UniformAxis) -> Array:
    """Return the heights [m] at the points of two axes, shape (x.number, y.number)."""
    shift = np.exp(2j * pi * (series.m * (x.first / x.period) + series.n * (y.first / y.period)))
    modes = np.zeros((x.number, y.number // 2 + 1), dtype=np.complex128)
    modes[series.m % x.number, series.n] = series.c * shift
    # irfft2 supplies the conjugates of columns n > 0; column 0 needs both m and −m.
    on_edge = series.n == 0
    modes[-series.m[on_edge] % x.number, 0] = np.conj(series.c * shift)[on_edge]
    heights = scipy.fft.irfft2(modes, s=(x.number, y.number), norm="forward", overwrite_x=True)
    return np.asarray(heights, dtype=np.float64)


def _maximum(series: _Series, x: UniformAxis, y: UniformAxis) -> float:
    """Return the maximum [m] of the series itself, not of its samples.

    With the maximum of the samples the depth of first touch would depend on the grid.
    """
    shortest = max(int(np.abs(series.m).max()), int(series.n.max()), 1)
    # At least eight samples per shortest wavelength, on shifted copies of the grid one after the
    # other: these take the memory of one grid, all samples at once would take 16 times as much.
    copies = [max(1, ceil(8 * shortest / axis.number)) for axis in (x, y)]
    tops: list[tuple[float, float, float]] = []
    for i, j in np.ndindex(*copies):
        axes = (
            axis._replace(first=axis.first + cells * axis.spacing)
            for axis, cells in ((x, i / copies[0]), (y, j / copies[1]))
        )
        tops = sorted(tops + _highest(series, *axes))[-4:]
    summits = [_climb(series, x, y, np.array(point)) for _, *point in tops]
    return max(tops[-1][0], *summits)


def _highest(series: _Series, x: UniformAxis, y: UniformAxis) -> list[tuple[float, float, float]]:
    """Return the height and the coordinates [m] of the four highest points of a grid."""
    heights = _sample(series, x, y)
    cells = np.unravel_index(np.argpartition(heights, -4, axis=None)[-4:], heights.shape)
    return [
        (float(heights[i, j]), float(x.first + i * x.spacing), float(y.first + j * y.spacing))
        for i, j in zip(*cells, strict=True)
    ]


def _climb(series: _Series, x: UniformAxis, y: UniformAxis, point: Array) -> float:
    """Return the height [m] at the maximum near ``point``, by Newton's method."""
    q = 2 * pi * np.stack([series.m / x.period, series.n / y.period], axis=1)
    for _ in range(4):
        wave = 2 * series.c * np.exp(1j * (q @ point))
        slope = -(q.T @ wave.imag)
        curvature = -(q.T * wave.real) @ q
        if np.linalg.det(curvature) <= 0:
            break
        point = point - np.linalg.solve(curvature, slope)
    return float(2 * np.sum((series.c * np.exp(1j * (q @ point))).real))
