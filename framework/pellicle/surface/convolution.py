"""Multiplication of a field by a real symbol in Fourier space."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, TypeVar

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from .sharing import blocks, shared

Float = TypeVar("Float", np.float32, np.float64)

# Cells in a block of rows or columns that one thread transforms at once, few enough for the cache.
_BLOCK: Final = 2**17
# Least number of columns in a block: numbers side by side are in one line of the cache.
_LINE: Final = 16
# Points of a transform below which it is one block: sharing it takes longer.
_SHARED: Final = 512**2


class Workspace:
    """Memory for one transform at a time, kept between transforms.

    Allocating it for each takes as long as half of a transform in double precision: the system
    hands out every page anew.
    """

    def __init__(self) -> None:
        self._buffer = np.empty(0, dtype=np.complex128)

    def array(self, shape: tuple[int, int], dtype: np.dtype[Any]) -> NDArray[Any]:
        """Return an array without defined values, valid until the next call."""
        number = shape[0] * shape[1]
        needed = -(-number * dtype.itemsize // self._buffer.itemsize)
        if self._buffer.size < needed:
            self._buffer = np.empty(needed, dtype=np.complex128)
        return self._buffer.view(dtype)[:number].reshape(shape)


def convolve(
    field: NDArray[Float],
    symbol: NDArray[Any],
    padded: tuple[int, int],
    workspace: Workspace,
    out: NDArray[Float] | None = None,
    visit: Callable[[NDArray[Float], slice], None] | None = None,
) -> NDArray[Float]:
    """Return the inverse transform of a symbol times the transform of a field.

    The transforms are those of `scipy.fft.rfft2`, of the field of shape (nx, ny) followed by zeros
    up to the shape ``padded``; only the first (nx, ny) values are returned, in ``out`` if given,
    which may be ``field``. ``symbol`` has the shape (px, py // 2 + 1), and the transform the
    precision of ``field``. ``visit`` is called with the result and a slice of its rows as soon as
    these are there and in the cache; threads may share the blocks of rows.
    """
    (nx, ny), (px, py) = field.shape, padded
    transform = workspace.array((px, py // 2 + 1), np.result_type(field, np.complex64))
    result = np.empty_like(field) if out is None else out

    # Row by row, so that rows of zeros are not transformed along y.
    def forward(rows: slice) -> None:
        transform[rows] = scipy.fft.rfft(field[rows], n=py, axis=1, workers=1)

    def multiplied(columns: slice) -> None:
        waves = transform[:, columns]
        waves[nx:] = 0
        waves = scipy.fft.fft(waves, axis=0, overwrite_x=True, workers=1)
        waves *= symbol[:, columns]
        waves = scipy.fft.ifft(waves, axis=0, overwrite_x=True, workers=1)
        if not np.may_share_memory(waves, transform):
            transform[:, columns] = waves

    def backward(rows: slice) -> None:
        result[rows] = scipy.fft.irfft(transform[rows], n=py, axis=1, workers=1)[:, :ny]
        if visit:
            visit(result, rows)

    block = max(_BLOCK, px * py if px * py < _SHARED else 0)
    rows = blocks(nx, max(1, block // py))
    shared(forward, rows)
    shared(multiplied, blocks(transform.shape[1], max(_LINE, block // px)))
    shared(backward, rows)
    return result
