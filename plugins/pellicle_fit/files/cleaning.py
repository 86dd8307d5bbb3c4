"""The rows of a measured curve that are fitted, and its passes into the solid and out of it."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pellicle.arrays import Array, Mask
from pellicle.errors import ConfigError, shown
from pellicle.units import readable

from .measurement import Measurement, Note, Segment

_FEWEST, _FEW = 8, 30
"""Least number of points of a fit, and the least that need no warning."""
_SIGNIFICANT = 4.0
"""Standard errors that the rise of the force must exceed."""
_MEDIANS = 200, 100, 50
"""Medians of neighbouring rows by which a motion is followed, at most twice as many."""
_LEAST_TURN, _CLEAR_TURN, _MEANT_TURN = 0.02, 8.0, 2.0
"""Least motion back after a turn: over the range, the noise, and the motions back on the way."""
_CYCLE, _MODULATED = 1 / 3, 0.1
"""Share of the range by which a curve that has turned twice moves, and a pass back, if told."""
_JUMP, _NEAR = 1.5, 20
"""Step between two segments over the largest tenth of all; rows over those from turn to pause."""
_LEAP, _OUT_OF_ORDER, _LEAPS = 0.25, 0.5, 3
"""Steps over the range that are few in rows that time orders, and in any; and how many are few."""
_LARGEST = 1e30
"""Largest size of what is measured, in SI; its inverse bounds how little it varies."""
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


def clean(curve: Measurement, segment: Segment = "approach") -> Measurement:
    """Return the rows of one pass into the solid (or out of it), or of both, in order of time.

    A speed is replaced by the time that follows from it.  Where the spring constant is known, the
    passes are told apart by the position of the cantilever's base, which has no noise.
    """
    z, f = _array(curve.position, "position"), _array(curve.force, "force")
    t = None if curve.time is None else _array(curve.time, "time")
    for name, values in (("force", f), ("time", t)):
        if values is not None and values.shape != z.shape:
            raise ConfigError(
                f"has {values.size} values and position {z.size}; give one for each position", name
            )
    messages, finite = [*curve.messages], np.isfinite(z) & np.isfinite(f)
    if missing := int(np.sum(~finite)):
        messages.append(Note(f"{missing} of {z.size} rows hold no finite number and were left out"))
    _check_count(int(finite.sum()), "the curve")
    for name, values, unit in (("position", z, "m"), ("force", f, "N"), ("time", t, "s")):
        if values is not None:
            _check_size(name, values, unit)
    number = np.flatnonzero(finite)
    if t is not None and (order := _order(t[finite], z[finite], segment)) is not None:
        number = number[order]
        messages.append(Note("the rows were put in order of time"))
    z, f, t = z[number], f[number], None if t is None else t[number]
    pause = None
    if curve.pause is not None:
        pause = np.asarray(curve.pause)[number]
        _check_count(int(np.sum(~pause)), "the curve without its pauses")
    if t is not None and not (np.isfinite(t).all() and np.all(np.diff(t) >= 0) and np.ptp(t)):
        reason = "falls, stands still or has a row without a number"
        messages.append(f"the time {reason}, so the curve is taken as one without time")
        t = None
    if not np.ptp(z):
        raise ConfigError(f"is {z[0]:g} m in every row; give a curve that moves", "position")
    base = z if curve.stiffness is None else z + f / curve.stiffness
    _check_rise(base, f)
    if t is None and curve.speed is not None:
        t = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(base)))]) / curve.speed
    found = passes(base, pause)
    first, last, unloading = _rows(base, found, segment)
    rows = np.arange(first, last + 1)
    if pause is not None and segment != "both":
        rows = rows[~pause[rows]]
    elif pause is not None and len(found) > 1:
        unloading = found[1].first
    if left := z.size - rows.size:
        which = "both passes" if segment == "both" else f"the {segment}"
        place, names = np.sort(number), []
        for kept in (True, False):
            own = np.isin(place, number[rows], invert=not kept)
            ends = np.flatnonzero(np.diff(np.concatenate([[False], own, [False]])))
            spans = zip(place[ends[::2]] + 1, place[ends[1::2] - 1] + 1, strict=True)
            names.append(" and ".join(f"{first} to {last}" for first, last in spans))
        text = f"rows {names[0]} are {which}; the other {left} ({names[1]}) were left out"
        messages.append(Note(text))
    way = -base[rows] if segment == "retract" else base[rows]
    back = float(np.max(np.maximum.accumulate(way) - way))
    if segment != "both" and back > _MODULATED * np.ptp(base):
        text = f"the position moves back by up to {readable(back, 'm', 2)} within the {segment}"
        messages.append(Note(f"{text}, which is fitted as one pass"))
    is_later = segment == "approach" and found[-1].first >= last
    later = number[found[-1].first : found[-1].last + 1]
    if segment == "retract":
        messages.append("a retract is fitted as if nothing adhered: compare with the approach")
    _check_count(rows.size, "it" if segment == "both" else f"its {segment}")
    if rows.size < _FEW:
        messages.append(f"only {rows.size} points: expect wide intervals")
    return replace(
        curve,
        position=z[rows],
        force=f[rows],
        time=None if t is None else t[rows],
        speed=None,
        messages=tuple(messages),
        left_out=(int(later.min()) + 1, int(later.max()) + 1) if is_later else None,
        unloading=rows >= unloading,
        pause=None if pause is None else pause[rows],
    )


def _order(time: Array, position: Array, segment: Segment) -> NDArray[np.intp] | None:
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


def _array(values: ArrayLike, name: str) -> Array:
    with suppress(TypeError, ValueError, OverflowError), np.errstate(over="ignore"):
        if not np.iscomplexobj(values) and (array := np.asarray(values, dtype=float)).ndim == 1:
            return array
    raise ConfigError(
        f"{shown(values)} is not a list of real numbers; give SI values, one curve at a time", name
    )


def _check_count(count: int, which: str) -> None:
    if count < _FEWEST:
        raise ConfigError(f"{which} has {count} points; a fit needs at least {_FEWEST}", "position")


def _check_size(name: str, values: Array, unit: str) -> None:
    """Raise if finite values are too large, or differ too little, for their squares."""
    known = values[np.isfinite(values)]
    row = int(np.argmax(np.where(np.isfinite(values), np.abs(values), 0.0)))
    if np.max(np.abs(known), initial=0.0) > _LARGEST:
        what = f"is {values[row]:g} {unit} in row {row + 1}"
    elif known.size and 0 < np.ptp(known) < 1 / _LARGEST:
        what = f"varies by {np.ptp(known):g} {unit}"
    else:
        return
    least = f"that vary by {1 / _LARGEST:g} {unit} or more"
    raise ConfigError(
        f"{what}; a fit needs values up to {_LARGEST:g} {unit} {least}: check the unit, and "
        "faulty rows",
        name,
    )


def _check_rise(z: Array, f: Array) -> None:
    """Raise unless the force is higher at the largest positions than at the smallest."""
    order = np.argsort(z, kind="stable")
    tenth = max(z.size // 10, 2)
    low, high = f[order[:tenth]], f[order[-tenth:]]
    rise = float(high.mean() - low.mean())
    # Neighbours differ by the noise and by the slope, so this is an upper bound of the noise.
    noise = float(np.sqrt(np.mean(np.diff(f[order]) ** 2) / 2))
    least = _SIGNIFICANT * noise * np.sqrt(2 / tenth)
    if rise < -least:
        raise ConfigError(
            f"falls by {readable(-rise, 'N', 3)} as the position grows: a negative stiffness; "
            "position must grow into the solid and force must push back, so change the sign of "
            "one of them, or take a height for an extension",
            "force",
        )
    if rise <= least or not rise:
        raise ConfigError(
            f"does not rise with the position (by {readable(rise, 'N', 2)} at a noise of "
            f"{readable(noise, 'N', 2)}): there is no contact in the curve; give one that goes "
            "deeper",
            "force",
        )


def _rows(base: Array, found: Sequence[Pass], segment: Segment) -> tuple[int, int, int]:
    """Return the first and the last row of a segment, and the first of unloading."""
    if len(found) > 2:
        raise ConfigError(
            f"goes to and fro {len(found)} times: several curves, or rows out of order; give one "
            "curve at a time, its rows in order",
            "position",
        )
    if segment == "both":
        # A base may settle a little before it moves in.
        if len(found) > 1 and abs(base[found[0].last] - base[0]) < _CYCLE * np.ptp(base):
            found = found[not found[0].inward :]
        if not found[0].inward:
            raise ConfigError(
                "does not begin with an approach, and both passes are to be fitted; give the rows "
                "in order of time, or set segment to the pass that there is",
                "position",
            )
        # At the turn the retract may rest, and hold noise.
        noise = _NORMAL * float(np.median(np.abs(np.diff(base, 2))))
        deepest = int(np.flatnonzero(base >= base.max() - _WILD * noise)[-1])
        out = max(found[1].first, deepest) + 1 if len(found) > 1 else base.size
        return found[0].first, base.size - 1, out
    is_approach = segment == "approach"
    for first, last, inward in found:
        if inward == is_approach:
            return first, last, base.size if is_approach else first
    way, other = ("out of", "a retract") if is_approach else ("into", "an approach")
    raise ConfigError(
        f"only moves {way} the solid: this is {other}, and the {segment} is to be fitted; give the "
        f"{segment}, or set segment to {other.split()[1]!r}",
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
    found = []
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
        found.append(Pass(int(rows[first]), int(rows[last]), inward))
    return found


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
    slow = speed < _SLOW * np.quantile(speed, _FAST_QUANTILE)
    count = int(np.argmin(slow[::-1])) + 1 if not slow.all() else 0
    if count < _PAUSE_BLOCKS:
        return 0
    begin, later = blocks[-count:][:2]
    # The block before holds rows of the ramp and, at most one block of creep earlier, of the pause.
    return rows.size - 1 - int(np.argmax(rows >= begin - 1.5 * max(later - begin, 0.0)))
