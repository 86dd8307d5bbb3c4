"""A part of a periodic plane around some cells, itself treated as periodic."""

from __future__ import annotations

from types import EllipsisType
from typing import Final

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from pellicle.arrays import Mask

# Share of an axis above which a window along it is not worth its copies.
_WHOLE: Final = 0.75


def window(cells: Mask, margin: int) -> tuple[NDArray[np.int64], ...] | EllipsisType:
    """Return the index of a rectangle around ``cells`` of one or two axes; `...` for all."""
    axes = range(cells.ndim)
    lines = [cells.any(axis=tuple(other for other in axes if other != axis)) for axis in axes]
    parts = [_interval(np.flatnonzero(line), line.size, margin) for line in lines]
    return ... if tuple(part.size for part in parts) == cells.shape else np.ix_(*parts)


def _interval(indices: NDArray[np.int64], number: int, margin: int) -> NDArray[np.int64]:
    """Return the indices of the shortest periodic interval around some, with a margin."""
    if not indices.size:
        return indices
    steps = np.diff(indices, append=indices[0] + number)
    widest = int(np.argmax(steps))
    extent = number - int(steps[widest]) + 1
    length = scipy.fft.next_fast_len(extent + 2 * margin, real=True)
    if length > _WHOLE * number:
        return np.arange(number)
    start = int(indices[(widest + 1) % indices.size]) - (length - extent) // 2
    interval: NDArray[np.int64] = (start + np.arange(length)) % number
    return interval
