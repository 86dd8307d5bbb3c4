"""Smooth extension of values on the contact to its surroundings, and its exact transpose."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from pellicle.arrays import Mask
from pellicle.surface import blocks, in_threads

from .biharmonic import Field, Sweeps, wrap_edges

Moments = tuple[Field, ...]

# Interpolation has the weights 3/4 and 1/4.
_THREE: Final = np.float32(3)
_ONE: Final = np.float32(1)
_QUARTER: Final = np.float32(0.25)
# Far below every total of weights above 0.
_TINY: Final = np.float32(1e-30)
# Fine cells in a block, few enough for its intermediate arrays to fit in the cache.
_BLOCK: Final = 2**17

# Cells along the longer edge of a level up to which it is interpolated by matrices, which take a
# tenth of the time at 20 cells and as long at 96.
_FEW: Final = 96

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

    ``known``, of shape (mx, my), is where the values are given; ``orders`` are α at the length
    scale of each level, the finest first. Both edges must be divisible by 2 as often as there are
    levels. ``stretch`` is the aspect ratio of the cells, see `biharmonic.stretch_of`.
    """

    def __init__(
        self, known: Mask, orders: Sequence[float], stretch: tuple[float, float] = (1.0, 1.0)
    ) -> None:
        self.shape = known.shape
        self._levels: list[_Level] = []
        # A line is squeezed to one axis.
        weight: Field | Mask = np.squeeze(known)
        any_bends = any(map(bends, orders))
        moments: Moments | None = None
        for order in orders:
            loss = np.float32(2.0 ** (min(order, weight.ndim) - weight.ndim))
            coarse, share, free = _coarse_weights(weight, loss)
            shift = moments if bends(order) else None
            sweeps = Sweeps(free, stretch) if bends(order) else None
            self._levels.append(_Level(free, share, shift, sweeps))
            if any_bends:
                moments = _coarse_moments(weight, moments, share)
            weight = coarse

    def apply(self, values: Field) -> Field:
        """Return E applied to ``values``, which are 0 where not known and are overwritten."""
        means = [np.squeeze(values)]
        for level in self._levels:
            means.append(_sum_of_block(means[-1], level.share))
        filled = means.pop()
        for level, own in zip(reversed(self._levels), reversed(means), strict=True):
            filled = level.fill(filled, own)
            if level.sweeps:
                level.sweeps.apply(filled)
        return filled.reshape(self.shape)

    def apply_transpose(self, values: Field) -> Field:
        """Return Eᵀ applied to ``values``, which are overwritten; meaningful where ``known``."""
        means = [np.squeeze(values)]
        for level in self._levels:
            if level.sweeps:
                level.sweeps.apply_transpose(means[-1])
            means.append(level.transposed_fill(means[-1]))
        result = means.pop()
        for level, own in zip(reversed(self._levels), reversed(means), strict=True):
            _add_repeated(result, level.share, own)
            result = own
        return result.reshape(self.shape)


@dataclass(frozen=True)
class _Level:
    free: Field | Mask
    """1 − w; bool on the finest level, in a quarter of the memory."""
    share: Field
    """Weight of each value in the mean of the coarser level."""
    moments: Moments | None
    """w × centroid of the known cells, in cells from the centre, where means are shifted."""
    sweeps: Sweeps | None
    """Where bending dominates."""

    def fill(self, coarse: Field, own: Field) -> Field:
        """Return this level from the coarser one and its own weighted means, overwriting these."""
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


def _coarse_weights(weight: Field | Mask, loss: np.float32) -> tuple[Field, Field, Field | Mask]:
    """Return the weights of the coarser level, `_Level.share` and `_Level.free`."""
    coarse = np.empty([n // 2 for n in weight.shape], np.float32)
    share, free = np.empty_like(coarse), np.empty_like(weight)

    def compute(rows: slice) -> None:
        fine = _fine(rows)
        total = _sums(weight[fine].astype(np.float32, copy=False))
        np.minimum(loss * total, _ONE, out=coarse[rows])
        # Where the total is 0 the share is multiplied by 0.
        np.maximum(total, _TINY, out=total)
        np.minimum(loss, _ONE / total, out=share[rows])
        if free.dtype == bool:
            np.logical_not(weight[fine], out=free[fine])
        else:
            np.subtract(_ONE, weight[fine], out=free[fine])

    in_threads(compute, _blocks(coarse.shape))
    return coarse, share, free


def _coarse_moments(weight: Field | Mask, moments: Moments | None, share: Field) -> Moments:
    """Return Σ ``share`` (w × position + moment) over 2 × 2 cells, positions from their centre.

    Cells of the finest level have no ``moments``: known values are at their centres.
    """
    coarse = []
    for axis, number in enumerate(weight.shape):
        signs = np.ones(number, dtype=np.float32)
        signs[0::2] = -1
        signed = weight * (signs[:, None] if axis < weight.ndim - 1 else signs)
        coarse.append(_QUARTER * _sum_of_block(signed))
    for axis, moment in enumerate(moments or ()):
        coarse[axis] += np.float32(0.5) * _sum_of_block(moment)
    return tuple(share * moment for moment in coarse)


def _slope(field: Field, axis: int) -> Field:
    """Return the central difference of a periodic field along an axis, per cell."""
    slope = np.roll(field, -1, axis) - np.roll(field, 1, axis)
    slope *= np.float32(0.5)
    return slope


def _sum_of_block(fine: Field, share: Field | None = None) -> Field:
    """Return the sums over 2 × 2 cells, or over two cells on a line, times a ``share`` if given."""
    coarse = np.empty([n // 2 for n in fine.shape], fine.dtype)

    def add(rows: slice) -> None:
        sums = _sums(fine[_fine(rows)])
        np.multiply(sums, _ONE if share is None else share[rows], out=coarse[rows])

    in_threads(add, _blocks(coarse.shape))
    return coarse


def _sums(fine: Field) -> Field:
    """Return the sums over 2 × 2 cells, or over two cells on a line, of one block."""
    # In one dimension: numpy takes longer for the rows of a view than for all of an array.
    shape = [n // 2 for n in fine.shape]
    pairs = (fine if fine.ndim == 1 else fine[0::2] + fine[1::2]).reshape(-1)
    sums: Field = (pairs[0::2] + pairs[1::2]).reshape(shape)
    return sums


def _add_repeated(coarse: Field, share: Field, fine: Field) -> None:
    """Add ``coarse`` × ``share`` to its 2 × 2 cells of ``fine``, or its two on a line."""

    def add(rows: slice) -> None:
        block = coarse[rows] * share[rows]
        pairs = np.empty((*block.shape, 2), block.dtype)
        pairs[..., 0] = block
        pairs[..., 1] = block
        repeated, target = pairs.reshape(*block.shape[:-1], -1), fine[_fine(rows)]
        if block.ndim == 1:
            target += repeated
        else:
            target[0::2] += repeated
            target[1::2] += repeated

    in_threads(add, _blocks(coarse.shape))


def _interpolate(coarse: Field, free: Field | Mask, own: Field) -> Field:
    """Return ``own`` + ``free`` × the (bi)linear interpolation from cells of twice the size.

    The sum is in ``own``.
    """
    if own.ndim == 2 and max(own.shape) <= _FEW:
        nx, ny = coarse.shape
        own += free * (_interpolation(nx) @ coarse @ _interpolation(ny).T)
        return own
    wide = wrap_edges(coarse)
    wide *= _QUARTER**coarse.ndim
    if coarse.ndim == 1:
        fine = np.empty_like(own)
        _refine(wide, fine)
        fine *= free
        own += fine
        return own

    def add(rows: slice) -> None:
        block = wide[rows.start : rows.stop + 2]
        fine = np.empty_like(own[_fine(rows)])
        nearer = _THREE * block[1:-1]
        _refine(nearer + block[:-2], fine[0::2])
        _refine(nearer + block[2:], fine[1::2])
        fine *= free[_fine(rows)]
        own[_fine(rows)] += fine

    in_threads(add, _blocks(coarse.shape))
    return own


def _transposed_interpolate(fine: Field, free: Field | Mask) -> Field:
    """Return the transpose of the map from ``coarse`` in `_interpolate`, applied to ``fine``."""
    if fine.ndim == 1:
        return _QUARTER * _transposed_refine(fine * free)
    if max(fine.shape) <= _FEW:
        nx, ny = (n // 2 for n in fine.shape)
        summed = _interpolation(nx).T @ (fine * free) @ _interpolation(ny)
        return np.asarray(summed, np.float32)
    coarse = np.empty([n // 2 for n in fine.shape], fine.dtype)

    def gather(rows: slice) -> None:
        start, stop = 2 * rows.start, 2 * rows.stop
        block = fine[start:stop] * free[start:stop]
        # Beside the block, on the periodic plane.
        before, after = (start - 1) % len(fine), stop % len(fine)
        even, odd = block[0::2], block[1::2]
        nearer = even + odd
        nearer *= _THREE
        nearer[:-1] += even[1:]
        nearer[-1] += fine[after] * free[after]
        nearer[1:] += odd[:-1]
        nearer[0] += fine[before] * free[before]
        np.multiply(_transposed_refine(nearer), _QUARTER * _QUARTER, out=coarse[rows])

    in_threads(gather, _blocks(coarse.shape))
    return coarse


@lru_cache
def _interpolation(number: int) -> Field:
    """Return the matrix of the linear interpolation from a periodic line to twice the cells."""
    matrix = np.zeros((2 * number, number), np.float32)
    cells = np.arange(number)
    for side in (0, 1):
        np.add.at(matrix, (2 * cells + side, cells), _THREE * _QUARTER)
        np.add.at(matrix, (2 * cells + side, (cells + 2 * side - 1) % number), _QUARTER)
    return matrix


def _refine(wide: Field, fine: Field) -> None:
    """Write 4 × the interpolation to twice as many cells along the last axis to ``fine``.

    The cells at the ends of ``wide`` are beyond those of ``fine``.
    """
    nearer, values = _THREE * wide, np.empty_like(wide)
    inner = values[..., 1:-1]
    # In one dimension numpy takes a quarter of the time; at the ends the sums are not used.
    nearer, wide, flat = nearer.reshape(-1), wide.reshape(-1), values.reshape(-1)
    np.add(nearer[1:], wide[:-1], out=flat[1:])
    fine[..., 0::2] = inner
    np.add(nearer[:-1], wide[1:], out=flat[:-1])
    fine[..., 1::2] = inner


def _transposed_refine(fine: Field) -> Field:
    """Return the transpose of `_refine` on a periodic axis, the last, applied to ``fine``."""
    even, odd = fine[..., 0::2], fine[..., 1::2]
    coarse: Field = even + odd
    coarse *= _THREE
    coarse += np.roll(even, -1, axis=-1)
    coarse += np.roll(odd, 1, axis=-1)
    return coarse


def _blocks(shape: Sequence[int]) -> list[slice]:
    """Return slices of the rows of coarse cells, block by block."""
    return blocks(shape[0], max(1, _BLOCK // (4 * math.prod(shape[1:]))))


def _fine(rows: slice) -> slice:
    return slice(2 * rows.start, 2 * rows.stop)
