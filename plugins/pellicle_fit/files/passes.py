"""The passes of a curve into the solid and out of it, told by where the motion turns."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array, Mask
from pellicle.errors import ConfigError

from .measurement import Segment

_MEDIANS = 200, 100, 50
"""Medians of neighbouring rows by which a motion is followed, at most twice as many."""
_LEAST_TURN, _CLEAR_TURN, _MEANT_TURN = 0.02, 8.0, 2.0
"""Least motion back after a turn: over the range, the noise, and the motions back on the way."""
_CYCLE = 1 / 3
"""Share of the range by which a curve that has turned twice moves."""
_JUMP, _NEAR = 1.5, 20
"""Step between two segments over the largest tenth of all; rows over those from turn to pause."""
_LEAP, _OUT_OF_ORDER, _LEAPS = 0.25, 0.5, 3
"""Steps over the range that are few in rows that time orders, and in any; and how many are few."""
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


def order_of_time(time: Array, position: Array, segment: Segment) -> NDArray[np.intp] | None:
    """Return the order of time if rows are not in it, and it makes them one motion, or else None.

    A time that begins anew with each segment would put rows of several in turn.
    """
    if not np.all(np.isfinite(time)) or np.all((steps := np.diff(time)) >= 0):
        return None
    order = np.argsort(time, kind="stable") if np.any(steps > 0) else np.arange(time.size)[::-1]
    blocks, falls = np.sum(np.abs(np.diff(order)) > 1), np.sum(steps < 0)
    position = (position - position.min()) / (np.ptp(position) or 1.0)
    leaps = np.sum(np.abs(np.diff(position[order])) > _LEAP)
    is_motion = leaps <= _LEAPS and (blocks <= _LEAPS or falls > time.size / 10)
    # Of a single approach, a time that falls is wrong.
    return order if is_motion and (position[order[0]] < 0.5 or segment == "retract") else None


def rows_of(base: Array, segments: Sequence[Pass], segment: Segment) -> tuple[int, int, int]:
    """Return the first and the last row of a segment, and the first of unloading."""
    if len(segments) > 2:
        raise ConfigError(
            f"goes to and fro {len(segments)} times: several curves, or rows out of order; give "
            "one curve at a time, its rows in order",
            "position",
        )
    if segment == "both":
        # A base may settle a little before it moves in.
        if len(segments) > 1 and abs(base[segments[0].last] - base[0]) < _CYCLE * np.ptp(base):
            segments = segments[not segments[0].inward :]
        if not segments[0].inward:
            raise ConfigError(
                "does not begin with an approach, and both passes are to be fitted; give the rows "
                "in order of time, or set segment to the pass that there is",
                "position",
            )
        # At the turn the retract may rest, and hold noise.
        noise = _NORMAL * float(np.median(np.abs(np.diff(base, 2))))
        deepest = int(np.flatnonzero(base >= base.max() - _WILD * noise)[-1])
        out = max(segments[1].first, deepest) + 1 if len(segments) > 1 else base.size
        return segments[0].first, base.size - 1, out
    is_approach = segment != "retract"
    for number, (first, last, inward) in enumerate(segments):
        if inward == is_approach:
            if segment == "approach+hold":
                # A hold of the tip moves the base by what a cantilever bends.
                least, later = _CYCLE * np.ptp(base), segments[number + 1 :]
                far = (f for f in later if abs(base[f.last] - base[f.first]) > least)
                last = next((f.first - 1 for f in far), base.size - 1)
            return first, last, base.size if is_approach else first
    way, name = ("out of", "a retract") if is_approach else ("into", "an approach")
    raise ConfigError(
        f"only moves {way} the solid: this is {name}, and the {segment} is to be fitted; give the "
        f"{segment}, or set segment to {name.split()[1]!r}",
        "position",
    )


def passes(base: Array, pause: Mask | None = None) -> list[Pass]:
    """Return the passes of positions in order of time, without the pauses at their deep ends.

    These are the rows of a ``pause`` where it is known, of shape (n,), or else are found.
    """
    rows = np.arange(base.size) if pause is None else np.flatnonzero(~pause)
    # A base at rest differs by rounding, since the deflection was subtracted.
    base = np.round((base[rows] - base.min()) / (np.ptp(base[rows]) or 1.0), 9)
    steps = np.abs(np.diff(base))
    jumps = {*np.flatnonzero(steps > _JUMP * np.quantile(steps, _FAST_QUANTILE)).tolist()}
    gaps = np.flatnonzero(np.diff(rows) > 1).tolist()
    ends, starts = [], [0]
    for turn in _turns(base):
        near = [row for row in gaps if abs(row - turn) * _NEAR <= base.size]
        ends.append(min(near, key=lambda row: abs(row - turn)) if near else turn)
        starts.append(ends[-1] + bool(near))
    segments = []
    for first, last in zip(starts, [*ends, base.size - 1], strict=True):
        inward = bool(base[last] > base[first])
        last -= last < base.size - 1 and last - 1 in jumps
        if pause is None:
            # Rows that rest at the turn are between the passes.
            while 0 < first < last and base[first + 1] == base[first]:
                first += 1
            while first < last < base.size - 1 and base[last - 1] == base[last]:
                last -= 1
            rest = _rest(base[first : last + 1][:: 1 if inward else -1])
            first, last = (first, last - rest) if inward else (first + rest, last)
        first += first > 0 and first in jumps
        segments.append(Pass(int(rows[first]), int(rows[last]), inward))
    return segments


def _turns(base: Array) -> list[int]:
    """Return the rows at which the motion turns: none or one, or more if it is several curves.

    Medians of neighbours have little noise.  Of the ways between their extremes the least is taken
    for part of its neighbours until two are left, of which the lesser has to stand out from the
    noise and from all that was taken: a motion that turns again and again is modulated.
    """
    span = float(np.ptp(base))
    leaps = np.flatnonzero(np.abs(np.diff(base)) > _OUT_OF_ORDER * span)
    if leaps.size > _LEAPS:
        return [int(row) for row in leaps]
    for count in _MEDIANS:
        size = max(base.size // count, 1)
        path = np.median(
            np.pad(base, (0, -base.size % size), "symmetric").reshape(-1, size), axis=1
        )
        noise = _NORMAL * float(np.median(np.abs(np.diff(path, 2))))
        if _CLEAR_TURN * noise <= _LEAST_TURN * span:
            break
    moving = np.flatnonzero(np.diff(path))
    turned = moving[:-1][np.diff(np.sign(np.diff(path)[moving])) != 0] + 1
    ends, back = [0, *turned.tolist(), path.size - 1], 0.0
    while len(ends) > 2:
        ways = np.abs(np.diff(path[ends]))
        index, least = int(np.argmin(ways)), float(ways.min())
        meant = max(_LEAST_TURN * span, _CLEAR_TURN * noise, _MEANT_TURN * back)
        if least >= (_CYCLE * span if ways.size > 2 else meant):
            break
        back = max(back, least if 0 < index < ways.size - 1 else 0.0)
        del ends[max(index, 1) : min(index + 2, len(ends) - 1)]
    turns = []
    for before, at in pairwise(ends[:-1]):
        first = max(at - 1, 0) * size
        near = base[first : (at + 2) * size] * np.sign(path[at] - path[before])
        turns.append(first + int(np.argmax(near)))
    return turns


def _rest(rows: Array) -> int:
    """Return how many rows at the end of an approach are a pause.

    In a pause the position creeps or is only noise; the rows of an approach and its pause are split
    into blocks, and those that move by less than a tenth of what the fast ones do are the pause.
    """
    size = rows.size // _BLOCKS
    if size < _BLOCK_ROWS:
        return 0
    blocks = np.median(rows[rows.size - size * _BLOCKS :].reshape(_BLOCKS, size), axis=1)
    speed = np.abs(np.diff(blocks))
    # Where nearly all rows rest, the speed of half of the way is that of the approach.
    fastest = np.sort(speed)[::-1]
    of_half = fastest[np.searchsorted(np.cumsum(fastest), fastest.sum() / 2)]
    slow = speed < _SLOW * max(np.quantile(speed, _FAST_QUANTILE), of_half)
    count = int(np.argmin(slow[::-1])) + 1 if not slow.all() else 0
    if count < _PAUSE_BLOCKS:
        return 0
    begin, later = blocks[-count:][:2]
    # The block before holds rows of the ramp and, at most one block of creep earlier, of the pause.
    return rows.size - 1 - int(np.argmax(rows >= begin - 1.5 * max(later - begin, 0.0)))
