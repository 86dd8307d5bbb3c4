"""Multiplication of a field by a real symbol in Fourier space."""

from __future__ import annotations

from typing import Any, Final, TypeVar

import numpy as np
import scipy.fft
from numpy.typing import NDArray

Float = TypeVar("Float", np.float32, np.float64)

# Cells in a block of rows that one thread transforms at once, few enough for the cache.
_BLOCK: Final = 2**17
# Points of a transform below which it is done on one thread: sharing it takes longer.
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
) -> NDArray[Float]:
    """Return the inverse transform of a symbol times the transform of a field.

    The transforms are those of `scipy.fft.rfft2`, of the field of shape (nx, ny) followed by zeros
    up to the shape ``padded``; only the first (nx, ny) values are returned, in ``out`` if given,
    which may be ``field``. ``symbol`` has the shape (px, py // 2 + 1), and the transform the
    precision of ``field``.
    """
    (nx, ny), (px, py) = field.shape, padded
    workers = None if px * py >= _SHARED else 1
    threads = scipy.fft.get_workers() if workers is None else 1
    transform = workspace.array((px, py // 2 + 1), np.result_type(field, np.complex64))
    rows = max(1, threads * _BLOCK // py)
    blocks = [slice(start, min(start + rows, nx)) for start in range(0, nx, rows)]
    # Row by row, so that rows of zeros are not transformed along y.
    for block in blocks:
        transform[block] = scipy.fft.rfft(field[block], n=py, axis=1, workers=workers)
    transform[nx:] = 0
    transform = scipy.fft.fft(transform, axis=0, overwrite_x=True, workers=workers)
    transform *= symbol
    transform = scipy.fft.ifft(transform, axis=0, overwrite_x=True, workers=workers)
    result = np.empty_like(field) if out is None else out
    for block in blocks:
        result[block] = scipy.fft.irfft(transform[block], n=py, axis=1, workers=workers)[:, :ny]
    return result
