"""Multiplication of a field by a real symbol in Fourier space, on blocks shared by threads."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from functools import lru_cache
from threading import Lock
from typing import Any, Final, TypeVar

import numpy as np
import scipy.fft
from numpy.typing import NDArray

Float = TypeVar("Float", np.float32, np.float64)
Block = TypeVar("Block")
Result = TypeVar("Result")

# Cells in a block of rows or columns that one thread transforms at once, few enough for the cache.
_BLOCK: Final = 2**17
# Least number of columns in a block: numbers side by side are in one line of the cache.
_LINE: Final = 16
# Points of a transform below which it is one block: sharing it takes longer.
_SHARED: Final = 512**2


# Cells in a block, few enough for its intermediate arrays to fit in the cache.
_PASS: Final = 2**16


class Workspace:
    """Memory for one transform at a time, kept between transforms.

    Allocating it for each takes as long as half of a transform in double precision: the system
    hands out every page anew.
    """

    _buffer = np.empty(0, dtype=np.complex128)

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
    in_threads(forward, rows)
    in_threads(multiplied, blocks(transform.shape[1], max(_LINE, block // px)))
    in_threads(backward, rows)
    return result


def blocks(number: int, length: int = _PASS) -> list[slice]:
    """Return slices of successive indices from 0 to ``number``, of ``length`` or fewer."""
    return [slice(start, min(start + length, number)) for start in range(0, number, length)]


def row_blocks(shape: tuple[int, ...]) -> list[slice]:
    """Return slices of the rows of a field, of as many cells as `blocks` have."""
    return blocks(shape[0], max(1, _PASS // max(1, math.prod(shape[1:]))))


def in_threads(work: Callable[[Block], Result], blocks: Sequence[Block]) -> list[Result]:
    """Return what ``work`` returns for each block, in the order of the blocks.

    As many threads as `scipy.fft.get_workers` says take the blocks as they become free; numpy and
    scipy.fft let other threads run while they compute. So ``work`` may write to its own block of an
    array only. What a block gives does not depend on the number of threads, and neither does a sum
    over the returned list.
    """
    threads = min(scipy.fft.get_workers(), len(blocks)) if len(blocks) > 1 else 1
    if threads == 1:
        return [work(block) for block in blocks]
    results: dict[int, Result] = {}
    remaining, drawing = enumerate(blocks), Lock()

    def drain() -> None:
        while True:
            # Without the GIL an iterator may give two threads the same block.
            with drawing:
                index, block = next(remaining, (-1, None))
            if block is None:
                return
            results[index] = work(block)

    # The handling of floating-point errors is a context variable of numpy.
    helpers = [_pool(threads - 1).submit(copy_context().run, drain) for _ in range(threads - 1)]
    try:
        drain()
    finally:
        for helper in helpers:
            if not helper.cancel():
                helper.result()
    return [results[index] for index in range(len(blocks))]


@lru_cache
def _pool(threads: int) -> ThreadPoolExecutor:
    """Return the threads that help the calling one; they are kept until the process ends."""
    return ThreadPoolExecutor(threads, thread_name_prefix="pellicle")
