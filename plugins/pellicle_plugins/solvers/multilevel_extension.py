"""Smooth extension of values on the contact to its surroundings, and its exact transpose."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from pellicle.arrays import Mask
from pellicle.numerics.sharing import blocks, shared

from .biharmonic import Sweeps, along, sweeps_near, wrapped
from .circulant_stiffness import Field

Moments = tuple[Field, ...]

_NEAR: Final = np.float32(0.75)
_FAR: Final = np.float32(0.25)
# Fine cells in a block, few enough for its intermediate arrays to fit in the cache.
_BLOCK: Final = 2**17

# Order of the stiffness above which the extension must not have kinks.
_BENDS: Final = 2.5


def bends(order: float) -> bool:
    """Whether bending dominates if the stiffness is proportional to q^``order``."""
    return order > _BENDS


class Extension:
    """E, which keeps values where ``known`` and extends them elsewhere with nearly least energy.

    A pyramid of fields: each level holds weighted means of 2 × 2 cells of the next finer one, with
    a weight w ≤ 1 for how far the contact determines the value of the cell. If the stiffness is
    proportional to q^α, the displacement around a point force falls as r^(α − 2), so the weight of
    an isolated cell changes by the factor 2^(α − 2) from level to level: 1 at order 2, one half at
    order 1. On the way back to finer levels the value of a cell is its own mean times w plus the
    interpolated coarser level times 1 − w.

    A bending energy penalises kinks. Where it dominates, a mean is shifted from the centroid of
    the known cells to the centre of its cell, along the slope of the interpolated coarser level,
    so that E preserves planes; and near the contact waves too short for the coarser level are
    relaxed towards Δ²u = 0.

    The domain is periodic. On a line of cells, as on a grid one cell across, a mean is over two
    cells, and the factor is 2^(α − 1). Single precision is enough for a preconditioner.

    Parameters
    ----------
    known
        Bool of shape (mx, my), where the values are given.
    orders
        α at the length scale of each level, the finest first; both edges must be divisible by 2 as
        often as there are levels.
    stretch
        The aspect ratio of the cells, see `biharmonic.stretch_of`; by default they are square.
    """

    def __init__(
        self,
        known: Mask,
        orders: Sequence[float],
        stretch: tuple[float, float] = (1.0, 1.0),
    ) -> None:
        self.shape = known.shape
        self._levels: list[_Level] = []
        # A line is squeezed to one axis.
        weight = np.squeeze(known.astype(np.float32))
        any_bends = any(map(bends, orders))
        moments: Moments | None = None
        for order in orders:
            total = _sum_of_block(weight)
            loss = 2.0 ** (min(order, weight.ndim) - weight.ndim)
            coarse = np.minimum(np.float32(loss) * total, np.float32(1))
            share = np.divide(coarse, total, out=total, where=total > 0)
            shift = moments if bends(order) else None
            free = 1 - weight
            sweeps = sweeps_near(free, stretch) if bends(order) else None
            self._levels.append(_Level(free, share, shift, sweeps))
            if any_bends:
                moments = _coarse_moments(weight, moments, share)
            weight = coarse

    def apply(self, values: Field) -> Field:
        """Return E applied to ``values``, which are 0 where not known and are overwritten.

        Both arrays have the shape (mx, my).
        """
        means = [np.squeeze(values)]
        for level in self._levels:
            means.append(_sum_of_block(means[-1]))
            means[-1] *= level.share
        filled = means.pop()
        for level, own in zip(reversed(self._levels), reversed(means), strict=True):
            filled = level.fill(filled, own)
            if level.sweeps:
                level.sweeps.apply(filled)
        return filled.reshape(self.shape)

    def apply_transpose(self, values: Field) -> Field:
        """Return Eᵀ applied to ``values``, which are overwritten; meaningful where ``known``.

        Both arrays have the shape (mx, my).
        """
        means = [np.squeeze(values)]
        for level in self._levels:
            if level.sweeps:
                level.sweeps.apply_transpose(means[-1])
            means.append(level.transposed_fill(means[-1]))
        result = means.pop()
        for level, own in zip(reversed(self._levels), reversed(means), strict=True):
            result *= level.share
            _add_repeated(result, own)
            result = own
        return result.reshape(self.shape)


@dataclass(frozen=True)
class _Level:
    free: Field
    """1 − w."""
    share: Field
    """Weight of each value in the mean of the coarser level."""
    moments: Moments | None
    """w × centroid of the known cells, in cells from the centre, where means are shifted."""
    sweeps: Sweeps | None
    """Where bending dominates."""

    def fill(self, coarse: Field, own: Field) -> Field:
        """Return this level from the coarser one and its own means times their weights.

        The own means are overwritten.
        """
        if self.moments is None:
            return _interpolate(coarse, self.free, own)
        smooth = _interpolate(coarse, np.ones_like(own), np.zeros_like(own))
        filled = smooth * self.free
        filled += own
        for axis, moment in enumerate(self.moments):
            filled -= moment * _slope(smooth, axis)
        return filled

    def transposed_fill(self, values: Field) -> Field:
        """Return the transpose of the map from the coarser level in `fill`."""
        if self.moments is None:
            return _transposed_interpolate(values, self.free)
        smooth = self.free * values
        for axis, moment in enumerate(self.moments):
            smooth += _slope(moment * values, axis)
        return _transposed_interpolate(smooth, np.ones_like(values))


def _coarse_moments(weight: Field, moments: Moments | None, share: Field) -> Moments:
    """Return Σ ``share`` (w × position + moment) over 2 × 2 cells, positions from their centre.

    Cells of the finest level have no ``moments``: known values are at their centres.
    """
    quarter, half = np.float32(0.25), np.float32(0.5)
    coarse = [quarter * _sum_of_block(_alternating(weight, axis)) for axis in range(weight.ndim)]
    for axis, moment in enumerate(moments or ()):
        coarse[axis] += half * _sum_of_block(moment)
    return tuple(share * moment for moment in coarse)


def _alternating(field: Field, axis: int) -> Field:
    signs = np.ones(field.shape[axis], dtype=np.float32)
    signs[0::2] = -1
    return field * (signs[:, None] if axis < field.ndim - 1 else signs)


def _slope(field: Field, axis: int) -> Field:
    """Return the central difference of a periodic field along an axis, per cell."""
    slope = np.roll(field, -1, axis) - np.roll(field, 1, axis)
    slope *= np.float32(0.5)
    return slope


def _sum_of_block(fine: Field) -> Field:
    """Return the sums over 2 × 2 cells, or over two cells on a line."""
    coarse = np.empty([n // 2 for n in fine.shape], fine.dtype)

    def add(rows: slice) -> None:
        block = fine[_fine(rows)]
        pairs = block[0::2] + block[1::2]
        coarse[rows] = pairs if pairs.ndim == 1 else pairs[:, 0::2] + pairs[:, 1::2]

    shared(add, _blocks(coarse.shape))
    return coarse


def _add_repeated(coarse: Field, fine: Field) -> None:
    """Add each value of ``coarse`` to its 2 × 2 cells of ``fine``, or its two on a line."""

    def add(rows: slice) -> None:
        fine[_fine(rows)] += _repeat(coarse[rows])

    shared(add, _blocks(coarse.shape))


def _repeat(coarse: Field) -> Field:
    if coarse.ndim == 1:
        return np.repeat(coarse, 2)
    fine = np.empty((2 * coarse.shape[0], 2 * coarse.shape[1]), coarse.dtype)
    fine[0::2, 0::2] = coarse
    fine[0::2, 1::2] = coarse
    fine[1::2] = fine[0::2]
    return fine


def _interpolate(coarse: Field, free: Field, own: Field) -> Field:
    """Return ``own`` + ``free`` × the (bi)linear interpolation from cells of twice the size.

    The sum is in ``own``.
    """
    wide = wrapped(coarse)

    def add(rows: slice) -> None:
        block = wide[rows.start : rows.stop + 2]
        for axis in range(coarse.ndim):
            block = _refined(block, axis)
        block *= free[_fine(rows)]
        own[_fine(rows)] += block

    shared(add, _blocks(coarse.shape))
    return own


def _transposed_interpolate(fine: Field, free: Field) -> Field:
    """Return the transpose of the map from ``coarse`` in `_interpolate`, applied to ``fine``."""
    coarse = np.empty([n // 2 for n in fine.shape], fine.dtype)

    def transposed(rows: slice) -> Field:
        block = fine[rows] * free[rows]
        return block if block.ndim == 1 else _transposed_refined(block)

    def gather(rows: slice) -> None:
        block = transposed(_fine(rows))
        even, odd = block[0::2], block[1::2]
        result = coarse[rows]
        np.add(even, odd, out=result)
        result *= _NEAR
        result[:-1] += _FAR * even[1:]
        result[1:] += _FAR * odd[:-1]
        # Beside the block, on the periodic plane.
        if len(result) < len(coarse):
            before, after = (2 * rows.start - 1) % len(fine), 2 * rows.stop % len(fine)
            odd, even = (transposed(slice(row, row + 1)) for row in (before, after))
        result[:1] += _FAR * odd[-1:]
        result[-1:] += _FAR * even[:1]

    shared(gather, _blocks(coarse.shape))
    return coarse


def _refined(wide: Field, axis: int) -> Field:
    """Interpolate to twice as many cells along an axis, without the cells at the ends."""
    near, far = _NEAR * wide[along(axis, 1, -1)], _FAR * wide
    fine = np.empty([n * (2 if i == axis else 1) for i, n in enumerate(near.shape)], near.dtype)
    np.add(near, far[along(axis, 0, -2)], out=fine[along(axis, 0, None, 2)])
    np.add(near, far[along(axis, 2)], out=fine[along(axis, 1, None, 2)])
    return fine


def _transposed_refined(fine: Field) -> Field:
    """Return the transpose of a periodic `_refined` along the second axis, applied to ``fine``."""
    even, odd = fine[:, 0::2], fine[:, 1::2]
    coarse = even + odd
    coarse *= _NEAR
    even, odd = _FAR * even, _FAR * odd
    coarse[:, :-1] += even[:, 1:]
    coarse[:, -1] += even[:, 0]
    coarse[:, 1:] += odd[:, :-1]
    coarse[:, 0] += odd[:, -1]
    return coarse


def _blocks(shape: Sequence[int]) -> list[slice]:
    """Return slices of the rows of coarse cells, block by block."""
    return blocks(shape[0], max(1, _BLOCK // (4 * math.prod(shape[1:]))))


def _fine(rows: slice) -> slice:
    """Return the rows of fine cells in rows of coarse ones."""
    return slice(2 * rows.start, 2 * rows.stop)
