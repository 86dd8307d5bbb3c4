"""Estimates of the noise of a curve: of neighbours, of steps of the detector, and of bins."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pellicle.arrays import Array

_TIES = 0.9
"""Different values per row below which values are taken to be steps of a detector."""
_OFF_STEP = 0.05
"""Share of a step by which values of a detector may lie beside it, after conversion."""
_EQUAL = 1e-9
"""Values closer than this, over the range, differ by rounding only."""
_RANK = 1e-6
"""Singular values below this, over the largest, belong to combinations of bins without rows."""


class BinnedNoise(NamedTuple):
    """Noise that sums over bins of rows show."""

    noise: float
    """Standard deviation of a row, if the sums were those of independent noise."""
    freedom: int
    """Degrees of freedom."""

    def excess(self, noise: float) -> float:
        """Return the variance of the sums over that of independent noise."""
        return (self.noise / noise) ** 2


def neighbour_noise(values: Array) -> float:
    """Return the standard deviation of independent noise, from the differences of neighbours.

    Drift and slow noise do not enter; two thirds as many degrees of freedom as values remain.
    """
    return float(np.sqrt(np.mean(np.diff(values) ** 2) / 2))


def resolution(values: Array) -> float:
    """Return the step of values that all lie a whole number of steps apart, 0 for any others."""
    steps = np.diff(np.unique(values))
    steps = steps[steps > _EQUAL * float(np.ptp(values))]
    if not 0 < steps.size < _TIES * values.size:
        return 0.0
    step = float(steps.min())
    # Equal values alone are no steps: a curve without noise is 0 before contact.
    counts = steps / step
    return step if np.all(np.abs(counts - np.round(counts)) < _OFF_STEP) else 0.0


def binned_noise(residuals: Array, jacobian: Array, bins: Array) -> BinnedNoise | None:
    """Return the noise that the sums of residuals over bins show; None if no bin is left.

    ``bins`` has a column for each bin, 1 in its rows.  The fit has removed what its ``jacobian``
    spans, so that is removed from the bins too; the sums are then made independent.
    """
    span, _ = np.linalg.qr(jacobian / np.maximum(np.linalg.norm(jacobian, axis=0), _tiny(jacobian)))
    left = bins - span @ (span.T @ bins)
    basis, sizes, _ = np.linalg.svd(left, full_matrices=False)
    basis = basis[:, sizes > _RANK * np.sqrt(residuals.size)]
    sums = basis.T @ (residuals - span @ (span.T @ residuals))
    if not sums.size:
        return None
    return BinnedNoise(float(np.sqrt(np.mean(sums**2))), sums.size)


def _tiny(matrix: Array) -> float:
    """Return a norm below which a column of a matrix counts as empty."""
    return float(np.finfo(float).eps) * float(np.linalg.norm(matrix))
