"""Operators of many functions of the wave, interpolated between a few waves.

A solid that relaxes answers the pressure of each earlier load step with another function of q. Over
the compliance G(q) at once these functions span few dimensions, so that one is known everywhere by
its values at a few waves: f(q) = G(q) Σ ℓ_b(q) f(q_b)/G(q_b). The waves q_b are those of a pivoted
QR factorisation of the span (Drmač & Gugercin 2016, SIAM J. Sci. Comput. 38, A631).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np
import scipy.fft

from pellicle.arrays import Array
from pellicle.grid import Grid

from .from_kernel import HasSymbol, operator_of
from .operators import Operator, weighted_sum

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

# Least part of a dimension of the span, over that of the largest.
_ACCURACY: Final = 1e-6
_PER_DECADE: Final = 32
# Waves beyond the longest and the shortest of a grid, where functions are taken to be constant.
_LONGER: Final = 1e8
_SHORTER: Final = 1e4
# The span of log q over the length of it on which functions become constant.
_SOFTNESS: Final = 128.0


def sampled_waves(grid: Grid) -> Array:
    """Return wavenumbers [rad/m], uniform in log q, far beyond those of a grid each way."""
    longest, shortest = 1 / (_LONGER * max(grid.size)), _SHORTER * np.pi / min(grid.spacing)
    return np.geomspace(longest, shortest, round(_PER_DECADE * np.log10(shortest / longest)))


class Span:
    """The waves by which functions of q are known, and the functions ℓ_b between them."""

    def __init__(self, q: Array, samples: Array) -> None:
        """Take functions over G(q), a row of ``samples`` for each, at `sampled_waves` ``q``."""
        # Both imports take long, and only a solid with a history outside its domain needs them.
        from scipy.interpolate import make_interp_spline
        from scipy.linalg import qr

        _, sizes, rows = np.linalg.svd(samples, full_matrices=False)
        span = rows[: np.count_nonzero(sizes > _ACCURACY * sizes[0])]
        _, _, order = qr(span, mode="economic", pivoting=True)
        pivots = np.sort(order[: len(span)])
        self.waves = q[pivots]
        """q_b [rad/m]."""
        between = np.linalg.solve(span[:, pivots], span)
        self.error = float(np.abs(samples[:, pivots] @ between - samples).max())
        """Largest error of a sample, over G(q)."""
        self.functions = [make_interp_spline(np.log(q), line, k=5) for line in between]


@dataclass(frozen=True)
class _Weighted:
    """G(q) times 1 + ℓ_b(q)/(2 max |ℓ_b|), which is positive as a kernel has to be."""

    kernel: HasSymbol
    function: BSpline

    @property
    def is_isotropic(self) -> bool:
        return True

    @property
    def largest(self) -> float:
        return float(np.abs(self.function.c).max())

    def symbol(self, qx: Array, qy: Array) -> Array:
        # Smoothly constant beyond the samples; a kink would be seen far around a point force.
        first, last = self.function.t[0], self.function.t[-1]
        width = (last - first) / _SOFTNESS
        above = np.logaddexp(0.0, (np.log(np.hypot(qx, qy)) - first) / width)
        log_q = last - width * np.logaddexp(0.0, _SOFTNESS - above)
        weighted: Array = self.kernel.symbol(qx, qy) * (
            1 + self.function(log_q) / (2 * self.largest)
        )
        return weighted


class FewWaves:
    """The operators of a `Span` on a grid with a free boundary."""

    def __init__(self, kernel: HasSymbol, span: Span, operator: Operator) -> None:
        """Take the ``operator`` of the ``kernel`` G(q)."""
        kinds = [_Weighted(kernel, function) for function in span.functions]
        self._operators = [operator, *(operator_of(kind, operator.grid) for kind in kinds)]
        for weighted in self._operators:
            weighted.on = lru_cache(weighted.on)
        self._factors = 2 * np.array([kind.largest for kind in kinds])

    def interpolated(self, values: Array) -> Operator:
        """Return the operator of the function with these ``values`` at the waves, over G there."""
        return weighted_sum(self._operators, [*self._weights(values)])

    def displacement(self, pressures: Array) -> Array:
        """Return the sum of the displacements [m] that the functions ℓ_b G make of ``pressures``.

        These are pressures [Pa] times f(q_b)/G(q_b), of shape (waves, nx, ny).
        """
        (nx, ny), padded = self._operators[0].grid.shape, self._operators[0].padded
        total: Array | float = 0.0
        for operator, field in zip(self._operators, self._weights(pressures), strict=True):
            total = total + scipy.fft.rfft2(field, padded) * operator.factors
        # One transform back for all waves.
        displacement: Array = scipy.fft.irfft2(total, padded)[:nx, :ny]
        return displacement

    @property
    def applications(self) -> int:
        """Applications of an operator that take as long as `displacement`, a half rounded up."""
        return 1 + len(self._operators) // 2

    def _weights(self, values: Array) -> Array:
        """Return what each operator counts, that of G first."""
        weights = (values.T * self._factors).T
        return np.concatenate([-weights.sum(axis=0, keepdims=True), weights])
