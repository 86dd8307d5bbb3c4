"""Smooth extension of values on the contact to its surroundings, and its exact transpose."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Field = NDArray[np.float32]


class Extension:
    """E: keeps values where ``known`` and continues them elsewhere as the least energy would.

    A pyramid of fields: each level holds weighted means of 2 × 2 cells of the level above it, with
    a weight w ≤ 1 that says how much of the cell the contact decides. A lone cell loses weight by
    2^(α − 2) from level to level, as the displacement round a point force falls, r^(α − 2), where
    the stiffness goes as q^α: nothing is lost at order 2, half at order 1. Coming up, a cell is its
    own mean by w and the interpolated level below by 1 − w.

    The domain is periodic. Single precision: it only ever preconditions.

    Parameters
    ----------
    known
        Bool of shape (mx, my), where the values are given.
    orders
        α at the length scale of each level, from the finest; no more levels than both edges can be
        halved.
    """

    def __init__(self, known: NDArray[np.bool_], orders: Sequence[float]) -> None:
        self.shape = known.shape
        weight = known.astype(np.float32)
        self._free: list[Field] = []
        self._shares: list[Field] = []
        for order in orders:
            self._free.append(1 - weight)
            total = _sum_of_four(weight)
            share = np.float32(2.0 ** (order - 2))
            weight = np.minimum(share * total, np.float32(1))
            np.divide(weight, total, out=total, where=total > 0)
            self._shares.append(total)

    def spread(self, values: Field) -> Field:
        """Return E applied to ``values``, which are 0 where not known; shape (mx, my)."""
        levels = [values]
        for share in self._shares:
            levels.append(_sum_of_four(levels[-1]))
            levels[-1] *= share
        filled = levels.pop()
        for free, own in zip(reversed(self._free), reversed(levels), strict=True):
            filled = _interpolate(filled)
            filled *= free
            filled += own
        return filled

    def gather(self, values: Field) -> Field:
        """Return the transpose of E applied to ``values``; of use only where known."""
        levels = [values]
        for free in self._free:
            levels.append(_transposed_interpolate(levels[-1] * free))
        gathered = levels.pop()
        for share, own in zip(reversed(self._shares), reversed(levels), strict=True):
            gathered *= share
            gathered = _repeat(gathered)
            gathered += own
        return gathered


def _sum_of_four(fine: Field) -> Field:
    rows = fine[0::2] + fine[1::2]
    return rows[:, 0::2] + rows[:, 1::2]


def _repeat(coarse: Field) -> Field:
    fine = np.empty((2 * coarse.shape[0], 2 * coarse.shape[1]), coarse.dtype)
    fine[0::2, 0::2] = coarse
    fine[0::2, 1::2] = coarse
    fine[1::2] = fine[0::2]
    return fine


def _interpolate(coarse: Field) -> Field:
    """Return the bilinear interpolation from cell centres to those of half the size."""
    n, m = coarse.shape
    near, far = 0.75 * coarse, 0.25 * coarse
    tall = np.empty((2 * n, m), coarse.dtype)
    np.add(near[1:], far[:-1], out=tall[2::2])
    np.add(near[:-1], far[1:], out=tall[1:-1:2])
    np.add(near[0], far[-1], out=tall[0])
    np.add(near[-1], far[0], out=tall[-1])
    near, far = 0.75 * tall, 0.25 * tall
    fine = np.empty((2 * n, 2 * m), coarse.dtype)
    np.add(near[:, 1:], far[:, :-1], out=fine[:, 2::2])
    np.add(near[:, :-1], far[:, 1:], out=fine[:, 1:-1:2])
    np.add(near[:, 0], far[:, -1], out=fine[:, 0])
    np.add(near[:, -1], far[:, 0], out=fine[:, -1])
    return fine


def _transposed_interpolate(fine: Field) -> Field:
    """Return the transpose of `_interpolate`."""
    even, odd = fine[:, 0::2], fine[:, 1::2]
    tall = 0.75 * (even + odd)
    even, odd = 0.25 * even, 0.25 * odd
    tall[:, :-1] += even[:, 1:]
    tall[:, -1] += even[:, 0]
    tall[:, 1:] += odd[:, :-1]
    tall[:, 0] += odd[:, -1]
    even, odd = tall[0::2], tall[1::2]
    coarse = 0.75 * (even + odd)
    even, odd = 0.25 * even, 0.25 * odd
    coarse[:-1] += even[1:]
    coarse[-1] += even[0]
    coarse[1:] += odd[:-1]
    coarse[0] += odd[-1]
    return coarse
