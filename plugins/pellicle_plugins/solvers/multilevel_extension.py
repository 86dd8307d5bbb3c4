"""Smooth extension of values on the contact to its surroundings, and its exact transpose."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from pellicle.arrays import Mask

from .circulant_stiffness import Field

Moments = tuple[Field, ...]

_NEAR: Final = np.float32(0.75)
_FAR: Final = np.float32(0.25)
# Fine cells that are worked on at a time, so that what is made of them stays in the cache.
_BLOCK: Final = 2**17

# Above this order of the stiffness bending decides.
_BENDS: Final = 2.5
_SWEEPS: Final = 16
# Δ² of waves from about nine cells to two, in units of the cell.
_SLOWEST, _FASTEST = 0.25, 64.0
# Roots of the Chebyshev polynomial from both ends in turns: in order their round-off grows.
_ROOTS: Final = np.cos(np.pi * (np.arange(_SWEEPS) + 0.5) / _SWEEPS)
# Over- and underrelaxation on that range.
_DAMPINGS: Final = tuple(
    np.float32(2 / (_FASTEST + _SLOWEST + (_FASTEST - _SLOWEST) * root))
    for pair in zip(_ROOTS[: _SWEEPS // 2], _ROOTS[::-1], strict=False)
    for root in pair
)


def bends(order: float) -> bool:
    """Whether bending decides where the stiffness goes as q^``order``."""
    return order > _BENDS


class Extension:
    """E: keeps values where ``known`` and continues them elsewhere as the least energy would.

    A pyramid of fields: each level holds weighted means of 2 × 2 cells of the level above it, with
    a weight w ≤ 1 that says how much of the cell the contact decides. A lone cell loses weight by
    2^(α − 2) from level to level, as the displacement round a point force falls, r^(α − 2), where
    the stiffness goes as q^α: nothing is lost at order 2, half at order 1. Coming up, a cell is its
    own mean by w and the interpolated level below by 1 − w.

    A bending energy punishes every kink. Where it decides, a mean is moved from the centroid of
    what is known to the centre of its cell, along the slope of the interpolated level below, so
    that E keeps planes; and the waves too short for that level are relaxed towards Δ²u = 0.

    The domain is periodic. On a line of cells, as on a grid one cell across, a mean is over two of
    them, and a lone cell loses weight by 2^(α − 1). Single precision: it only ever preconditions.

    Parameters
    ----------
    known
        Bool of shape (mx, my), where the values are given.
    orders
        α at the length scale of each level, from the finest; no more levels than both edges can be
        halved.
    stretch
        What `stretch_of` says of the cells; they are square if it is left out.
    """

    def __init__(
        self,
        known: Mask,
        orders: Sequence[float],
        stretch: tuple[float, float] = (1.0, 1.0),
    ) -> None:
        self.shape = known.shape
        # Inside, a line has one axis.
        self._stretch = stretch
        self._levels: list[_Level] = []
        weight = np.squeeze(known.astype(np.float32))
        any_bends = any(map(bends, orders))
        moments: Moments | None = None
        for order in orders:
            total = _sum_of_block(weight)
            kept = 2.0 ** (min(order, weight.ndim) - weight.ndim)
            below = np.minimum(np.float32(kept) * total, np.float32(1))
            share = np.divide(below, total, out=total, where=total > 0)
            moved = moments if bends(order) else None
            self._levels.append(_Level(1 - weight, share, moved, bends(order)))
            if any_bends:
                moments = _moments_below(weight, moments, share)
            weight = below

    def spread(self, values: Field) -> Field:
        """Return E applied to ``values``, which are 0 where not known; shape (mx, my)."""
        means = [np.squeeze(values)]
        for level in self._levels:
            means.append(_sum_of_block(means[-1]))
            means[-1] *= level.share
        filled = means.pop()
        for level, own in zip(reversed(self._levels), reversed(means), strict=True):
            filled = level.fill(filled, own)
            for damping in _DAMPINGS if level.relaxes else ():
                change = biharmonic(filled, self._stretch)
                change *= damping
                change *= level.free
                filled -= change
        return filled.reshape(self.shape)

    def gather(self, values: Field) -> Field:
        """Return the transpose of E applied to ``values``; of use only where known."""
        means = [np.squeeze(values)]
        for level in self._levels:
            for damping in reversed(_DAMPINGS) if level.relaxes else ():
                change = biharmonic(level.free * means[-1], self._stretch)
                change *= damping
                means[-1] = means[-1] - change
            means.append(level.transposed_fill(means[-1]))
        gathered = means.pop()
        for level, own in zip(reversed(self._levels), reversed(means), strict=True):
            gathered *= level.share
            gathered = _repeat(gathered)
            gathered += own
        return gathered.reshape(self.shape)


@dataclass(frozen=True)
class _Level:
    free: Field
    """1 − w."""
    share: Field
    """What each value counts for in the mean below it."""
    moments: Moments | None
    """w × centroid of what is known, in cells from the centre, where means are moved."""
    relaxes: bool

    def fill(self, below: Field, own: Field) -> Field:
        """Return this level, from the one below and its own means by their weights."""
        if self.moments is None:
            return _interpolate(below, self.free, own)
        smooth = _interpolate(below, np.ones_like(own), np.zeros_like(own))
        filled = smooth * self.free
        filled += own
        for axis, moment in enumerate(self.moments):
            filled -= moment * _slope(smooth, axis)
        return filled

    def transposed_fill(self, values: Field) -> Field:
        """Return the transpose of `fill`'s map from the level below."""
        if self.moments is None:
            return _transposed_interpolate(values, self.free)
        smooth = self.free * values
        for axis, moment in enumerate(self.moments):
            smooth += _slope(moment * values, axis)
        return _transposed_interpolate(smooth, np.ones_like(values))


def _moments_below(weight: Field, moments: Moments | None, share: Field) -> Moments:
    """Return Σ ``share`` (w × place + moment) of each 2 × 2 cells, places from their centre.

    Cells of the finest level have no ``moments``: what is known is at their centres.
    """
    quarter, half = np.float32(0.25), np.float32(0.5)
    below = [quarter * _sum_of_block(_alternating(weight, axis)) for axis in range(weight.ndim)]
    for axis, moment in enumerate(moments or ()):
        below[axis] += half * _sum_of_block(moment)
    return tuple(share * moment for moment in below)


def _alternating(field: Field, axis: int) -> Field:
    signs = np.ones(field.shape[axis], dtype=np.float32)
    signs[0::2] = -1
    return field * (signs[:, None] if axis < field.ndim - 1 else signs)


def _slope(field: Field, axis: int) -> Field:
    """Return the central difference of a periodic field along an axis, over a cell."""
    slope = np.roll(field, -1, axis) - np.roll(field, 1, axis)
    slope *= np.float32(0.5)
    return slope


def _sum_of_block(fine: Field) -> Field:
    """Return the sum of each 2 × 2 cells, of each two on a line."""
    rows = fine[0::2] + fine[1::2]
    return rows if rows.ndim == 1 else rows[:, 0::2] + rows[:, 1::2]


def _repeat(coarse: Field) -> Field:
    if coarse.ndim == 1:
        return np.repeat(coarse, 2)
    fine = np.empty((2 * coarse.shape[0], 2 * coarse.shape[1]), coarse.dtype)
    fine[0::2, 0::2] = coarse
    fine[0::2, 1::2] = coarse
    fine[1::2] = fine[0::2]
    return fine


def _interpolate(coarse: Field, free: Field, own: Field) -> Field:
    """Return ``own`` + ``free`` × the bilinear interpolation from cells of twice the size."""
    if coarse.ndim == 1:
        line = np.repeat(_NEAR * coarse, 2)
        line[0::2] += _FAR * np.roll(coarse, 1)
        line[1::2] += _FAR * np.roll(coarse, -1)
        line *= free
        line += own
        return line
    n, m = coarse.shape
    fine = np.empty((2 * n, 2 * m), coarse.dtype)
    wide = _wrapped(coarse)
    for rows in _blocks(n, m):
        here = slice(2 * rows.start, 2 * rows.stop)
        block = wide[rows.start : rows.stop + 2]
        near, far = _NEAR * block[1:-1], _FAR * block
        tall = np.empty((2 * len(near), m + 2), coarse.dtype)
        np.add(near, far[:-2], out=tall[0::2])
        np.add(near, far[2:], out=tall[1::2])
        near, far = _NEAR * tall[:, 1:-1], _FAR * tall
        filled = np.empty((len(tall), 2 * m), coarse.dtype)
        np.add(near, far[:, :-2], out=filled[:, 0::2])
        np.add(near, far[:, 2:], out=filled[:, 1::2])
        filled *= free[here]
        np.add(filled, own[here], out=fine[here])
    return fine


def _transposed_interpolate(fine: Field, free: Field) -> Field:
    """Return the transpose of `_interpolate`'s map from the coarse cells, applied to ``fine``."""
    if fine.ndim == 1:
        even, odd = (free * fine).reshape(-1, 2).T
        line = _NEAR * (even + odd)
        line += _FAR * (np.roll(even, -1) + np.roll(odd, 1))
        return line
    n, m = fine.shape[0] // 2, fine.shape[1] // 2
    wide = np.zeros((n + 2, m + 2), fine.dtype)
    for rows in _blocks(n, m):
        here = slice(2 * rows.start, 2 * rows.stop)
        block = fine[here] * free[here]
        even, odd = block[:, 0::2], block[:, 1::2]
        tall = np.zeros((len(block), m + 2), fine.dtype)
        np.add(even, odd, out=tall[:, 1:-1])
        tall *= _NEAR
        tall[:, :-2] += _FAR * even
        tall[:, 2:] += _FAR * odd
        even, odd = tall[0::2], tall[1::2]
        wide[rows.start + 1 : rows.stop + 1] += _NEAR * (even + odd)
        wide[rows.start : rows.stop] += _FAR * even
        wide[rows.start + 2 : rows.stop + 2] += _FAR * odd
    wide[1] += wide[-1]
    wide[-2] += wide[0]
    wide[:, 1] += wide[:, -1]
    wide[:, -2] += wide[:, 0]
    return wide[1:-1, 1:-1]


def stretch_of(dx: float, dy: float) -> tuple[float, float]:
    """Return (h/dx)² and (h/dy)², h such that their sum is 2."""
    ratio = (dx / dy) ** 2
    return 2 / (1 + ratio), 2 * ratio / (1 + ratio)


def biharmonic(field: Field, stretch: tuple[float, float]) -> Field:
    """Return h⁴ Δ² of a periodic field; no wave has more than 64.

    ``stretch`` is that of the cells; h is their edge if they are square.
    """
    return _laplacian(_laplacian(field, stretch), stretch)


def _laplacian(field: Field, stretch: tuple[float, float]) -> Field:
    if field.ndim == 1:
        line = np.float32(-2) * field
        line[1:] += field[:-1]
        line[:-1] += field[1:]
        line[0] += field[-1]
        line[-1] += field[0]
        return line
    x, y = stretch
    wide = _wrapped(field)
    change = np.float32(-4 / x) * field
    change += wide[:-2, 1:-1]
    change += wide[2:, 1:-1]
    if x != y:
        change *= np.float32(x / y)
    change += wide[1:-1, :-2]
    change += wide[1:-1, 2:]
    if y != 1:
        change *= np.float32(y)
    return change


def _wrapped(field: Field) -> Field:
    """Return a periodic field with one more cell at each end of each axis."""
    n, m = field.shape
    wide = np.empty((n + 2, m + 2), field.dtype)
    wide[1:-1, 1:-1] = field
    wide[0, 1:-1], wide[-1, 1:-1] = field[-1], field[0]
    wide[:, 0], wide[:, -1] = wide[:, -2], wide[:, 1]
    return wide


def _blocks(n: int, m: int) -> Iterator[slice]:
    """Yield slices of the ``n`` rows of coarse cells, ``m`` to a row, one block each."""
    rows = max(1, _BLOCK // (4 * m))
    for start in range(0, n, rows):
        yield slice(start, min(start + rows, n))
