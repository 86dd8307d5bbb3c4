"""Work on blocks of large arrays, shared by threads."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from functools import lru_cache
from typing import Final, TypeVar

import scipy.fft

Block = TypeVar("Block")
Result = TypeVar("Result")

# Cells in a block, few enough for its intermediate arrays to fit in the cache.
_BLOCK: Final = 2**16


def blocks(number: int, length: int = _BLOCK) -> list[slice]:
    """Return slices of successive indices from 0 to ``number``, of ``length`` or fewer."""
    return [slice(start, min(start + length, number)) for start in range(0, number, length)]


def row_blocks(shape: tuple[int, ...]) -> list[slice]:
    """Return slices of the rows of a field, of as many cells as `blocks` have."""
    return blocks(shape[0], max(1, _BLOCK // max(1, math.prod(shape[1:]))))


def shared(work: Callable[[Block], Result], blocks: Sequence[Block]) -> list[Result]:
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
    remaining = enumerate(blocks)

    def drain() -> None:
        for index, block in remaining:
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
