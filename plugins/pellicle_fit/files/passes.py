"""The passes of an indenter into a solid and out of it, and the pauses between them."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from pellicle.arrays import Array

_TURN = 0.5
"""Share of the largest motion by which a pass moves at least."""
_BLOCKS, _BLOCK_ROWS = 50, 4
"""Parts of a pass in which a pause is sought, and their least number of rows."""
_SLOW, _FAST_QUANTILE = 0.1, 0.9
"""Largest speed in a pause over that quantile of all speeds."""
_PAUSE_BLOCKS = 3
"""Least number of blocks of a pause; a position that turns as a sine is as slow in one."""
_NORMAL = 1.4826 / np.sqrt(6)
"""Standard deviation of noise over the median size of its second differences."""
_WILD = 4.0
"""Standard deviations of noise below the largest position within which the indenter rests."""


class Pass(NamedTuple):
    """Rows from ``first`` to ``last``, both included, of a motion one way."""

    first: int
    last: int
    inward: bool
    """Whether the position grows, into the solid."""


def passes(base: Array) -> list[Pass]:
    """Return the passes of positions in order of time, without the pauses at their deep ends.

    A change of direction counts where the position moves back by half of its range.
    """
    least = _TURN * float(np.ptp(base))
    turns: list[int] = []
    low = high = direction = 0
    for row, value in enumerate(base.tolist()):
        high = row if value > base[high] else high
        low = row if value < base[low] else low
        if direction >= 0 and base[high] - value >= least:
            turns += [high] if direction else []
            direction, low = -1, row
        elif direction <= 0 and value - base[low] >= least:
            turns += [low] if direction else []
            direction, high = 1, row
    found = []
    for first, last in pairwise([0, *turns, base.size - 1]):
        inward = bool(base[last] > base[first])
        # Rows that rest at the turn precede the pass.
        while first and base[first + 1] == base[first]:
            first += 1
        rest = _rest(base[first : last + 1] if inward else base[first : last + 1][::-1])
        found.append(Pass(first, last - rest, True) if inward else Pass(first + rest, last, False))
    return found


def first_out(base: Array, retract: Pass) -> int:
    """Return the first row of a retract after the turn, where it may rest and hold noise."""
    noise = _NORMAL * float(np.median(np.abs(np.diff(base, 2))))
    deepest = int(np.flatnonzero(base >= base.max() - _WILD * noise)[-1])
    return max(retract.first, deepest) + 1


def _rest(rows: Array) -> int:
    """Return how many rows at the end of an approach are a pause.

    In a pause the position creeps or is only noise; the rows of an approach and its pause are split
    into blocks, and those that move by less than a tenth of what the fast ones do are the pause.
    """
    size = rows.size // _BLOCKS
    if size < _BLOCK_ROWS:
        return 0
    blocks = rows[rows.size - size * _BLOCKS :].reshape(_BLOCKS, size)
    speed = np.abs(blocks @ (np.arange(size) - (size - 1) / 2))
    slow = speed < _SLOW * np.quantile(speed, _FAST_QUANTILE)
    count = int(np.argmin(slow[::-1])) if not slow.all() else 0
    if count < _PAUSE_BLOCKS:
        return 0
    begin, later = np.median(blocks[-count : 2 - count], axis=1)
    # The block before holds rows of the ramp and, at most one block of creep earlier, of the pause.
    return rows.size - 1 - int(np.argmax(rows >= begin - 1.5 * max(later - begin, 0.0)))
