"""Passes over large arrays, block by block."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final, TypeVar

Part = TypeVar("Part")

# Cells in a block, few enough for its intermediate arrays to fit in the cache.
_BLOCK: Final = 2**16


def over_blocks(work: Callable[[slice], Part], number: int) -> Iterator[Part]:
    """Yield the result of ``work`` for each block of indices from 0 to ``number``, in order."""
    return (work(slice(start, start + _BLOCK)) for start in range(0, number, _BLOCK))
