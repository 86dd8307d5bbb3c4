"""Smooth extension of values on the contact to its surroundings, and its exact transpose."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Field = NDArray[np.float32]



def levels_within(shape: tuple[int, int]) -> int:
    """Return how often a field of this shape can be halved and still have two cells each way."""
    return min(6, max(0, min(shape).bit_length() - 2))


class Extension:
    """E: keeps values where ``known``, fills the rest from a pyramid of means.

    Going down, each level holds the mean of the known values of 2 × 2 cells. Coming up, cells that
    are known keep their value and the others are interpolated from the level below. The domain is
    periodic; its edges are multiples of a power of two for the pyramid to be deep. Single
    precision: it only ever preconditions.

    Parameters
    ----------
    known
        Bool of shape (mx, my), where the values are given.
    """

    def __init__(self, known: NDArray[np.bool_]) -> None:
        self._known = [known]
        self._weights: list[Field] = []
        while min(known.shape) >= 4 and not any(n % 2 for n in known.shape):
            if known.all():
                break
            count = _sum_of_four(known.astype(np.float32))
            self._weights.append(1 / np.maximum(count, 1))
            known = count > 0
            self._known.append(known)

    def spread(self, values: Field) -> Field:
        """Return E applied to ``values``, which are 0 where not known; shape (mx, my)."""
        levels = [values]
        for weight in self._weights:
            levels.append(_sum_of_four(levels[-1]))
            levels[-1] *= weight
        filled = levels.pop()
        for known, given in zip(self._known[-2::-1], reversed(levels), strict=True):
            filled = _interpolate(filled)
            np.copyto(filled, given, where=known)
        return filled

    def gather(self, values: Field) -> Field:
        """Return the transpose of E applied to ``values``; 0 where not known."""
        kept = []
        for known in self._known[:-1]:
            kept.append(values * known)
            values = _transposed_interpolate(values - kept[-1])
        gathered = values * self._known[-1]
        for own, weight, known in zip(
            reversed(kept), reversed(self._weights), self._known[-2::-1], strict=True
        ):
            gathered *= weight
            gathered = _repeat(gathered)
            gathered *= known
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
    tall[0] = near[0] + far[-1]
    tall[-1] = near[-1] + far[0]
    near, far = 0.75 * tall, 0.25 * tall
    fine = np.empty((2 * n, 2 * m), coarse.dtype)
    np.add(near[:, 1:], far[:, :-1], out=fine[:, 2::2])
    np.add(near[:, :-1], far[:, 1:], out=fine[:, 1:-1:2])
    fine[:, 0] = near[:, 0] + far[:, -1]
    fine[:, -1] = near[:, -1] + far[:, 0]
    return fine


def _transposed_interpolate(fine: Field) -> Field:
    n, m = fine.shape[0] // 2, fine.shape[1] // 2
    even, odd = fine[:, 0::2], fine[:, 1::2]
    tall = even + odd
    tall *= 0.75
    tall[:, :-1] += 0.25 * even[:, 1:]
    tall[:, -1] += 0.25 * even[:, 0]
    tall[:, 1:] += 0.25 * odd[:, :-1]
    tall[:, 0] += 0.25 * odd[:, -1]
    even, odd = tall[0::2], tall[1::2]
    coarse = even + odd
    coarse *= 0.75
    coarse[:-1] += 0.25 * even[1:]
    coarse[-1] += 0.25 * even[0]
    coarse[1:] += 0.25 * odd[:-1]
    coarse[0] += 0.25 * odd[-1]
    return coarse.reshape(n, m)
