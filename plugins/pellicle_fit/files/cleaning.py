"""The rows of a measured curve that are fitted, and its passes into the solid and out of it."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.errors import ConfigError, shown
from pellicle.units import readable

from .measurement import Measurement, Note, Segment

_FEWEST, _FEW = 8, 30
"""Least number of points of a fit, and the least that need no warning."""
_SIGNIFICANT = 4.0
"""Standard errors that the rise of the force must exceed."""
_TURN = 0.5
"""Share of the largest motion by which a pass moves at least."""
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
    for name, values, unit in (("position", z, "m"), ("force", f, "N"), ("time", t, "s")):
        if values is not None:
            _check_size(name, values, unit)
    z, f, t = z[finite], f[finite], None if t is None else t[finite]
    _check_count(z.size, "the curve")
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
    found = passes(base)
    first, last, unloading = _rows(base, found, segment)
    if left_out := z.size - 1 - last + first:
        text = f"rows {first + 1} to {last + 1} are the {segment}; the other {left_out} were"
        messages.append(Note(f"{text} left out"))
    others = [one for one in found if segment == "approach" and one.first >= last]
    if segment == "retract":
        messages.append("a retract is fitted as if nothing adhered: compare with the approach")
    rows = np.arange(first, last + 1)
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
        left_out=(others[0].first + 1, others[0].last + 1) if others else None,
        unloading=rows >= unloading,
    )


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
        return 0, base.size - 1, out
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
