"""Blocks of large arrays."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

# Cells in a block, few enough for its intermediate arrays to fit in the cache.
_BLOCK: Final = 2**16


def blocks(number: int) -> Iterator[slice]:
    """Yield slices of successive indices from 0 to ``number``."""
    return (slice(start, start + _BLOCK) for start in range(0, number, _BLOCK))
