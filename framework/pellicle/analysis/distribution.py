"""The probability density of the values of a field."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array


@dataclass(frozen=True)
class Distribution:
    """Probability density over bins, with Σ density · width = 1."""

    edges: Array
    """Ends of the bins, shape (bins + 1,)."""
    density: Array
    """Fraction of the samples in each bin, divided by the width of the bin."""
    mean: Array
    """Mean of the samples in each bin; the middle of an empty one."""

    @property
    def width(self) -> Array:
        """Width of each bin."""
        return np.diff(self.edges)


def distribution(values: ArrayLike, bins: int = 50) -> Distribution:
    """Return the distribution of samples over a number of equal bins from 0 to the highest value.

    The samples are of any shape, such as the pressure of the cells in contact. Infinite ones, such
    as the gap where there is no indenter, are left out. Negative ones extend the bins below 0.
    There are no bins if there are no samples or all of them are 0.
    """
    flat = np.asarray(values, dtype=np.float64).ravel()
    samples = flat[np.isfinite(flat)]
    low, high = samples.min(initial=0.0), samples.max(initial=0.0)
    if low == high:
        return Distribution(np.zeros(1), np.zeros(0), np.zeros(0))
    count, edges = np.histogram(samples, bins, (low, high))
    total, _ = np.histogram(samples, bins, (low, high), weights=samples)
    middle = (edges[1:] + edges[:-1]) / 2
    mean = np.where(count > 0, total / np.maximum(count, 1), middle)
    return Distribution(edges, count / (samples.size * np.diff(edges)), mean)
