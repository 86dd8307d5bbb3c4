"""The selection of the rows of a measured curve that are fitted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array, Mask
from pellicle.errors import ConfigError, shown
from pellicle.units import readable

from .measurement import Measurement, Note, Segment

FEWEST = 8
"""Least number of points of a fit."""
_FEW = 30
_LARGEST_RATIO = 1e6
"""Largest ratio of the stiffnesses of cantilever and curve, either way, that is fitted."""
LARGEST = 1e30
"""Largest SI value that is fitted; the smallest is one over this."""
_TURN = 0.5
"""Share of its range by which the position must move back for a change of direction to count."""
_BLOCKS, _BLOCK_ROWS = 50, 4
"""Parts of a pass in which a pause is sought, and their least number of rows."""
_SLOW, _FAST_QUANTILE = 0.1, 0.9
"""Largest speed in a pause over that quantile of all speeds."""
_PAUSE_BLOCKS = 3
"""Least number of blocks of a pause; a position that turns as a sine is as slow in one."""
_SIGNIFICANT = 4.0
"""Standard errors that the rise of the force must exceed."""


def clean(curve: Measurement, segment: Segment = "approach") -> Measurement:
    """Return the rows of one pass into the solid (or out of it), sorted by position, or of both.

    Both passes are in order of time.  A speed is replaced by the time that follows from it.  Where
    the spring constant is known, the passes are told apart by the position of the
    cantilever's base, which has no noise.

    Raises
    ------
    ConfigError
        Shapes differ, there are too few points, several passes or only the other pass, or the
        force falls, or does not rise, as the position grows.
    """
    z, f = _array(curve.position, "position"), _array(curve.force, "force")
    if z.shape != f.shape:
        raise ConfigError(
            f"has {f.size} values and position {z.size}; give one for each position", "force"
        )
    messages = list(curve.messages)
    finite = np.isfinite(z) & np.isfinite(f)
    if missing := int(np.sum(~finite)):
        text = f"{missing} of {z.size} rows hold no finite number and were left out"
        messages.append(Note(text))
    t = None if curve.time is None else _time(curve.time, finite)
    z, f = z[finite], f[finite]
    _check_count(z, "the curve")
    _check_si(z, "position", "m")
    _check_si(f, "force", "N")
    span = float(np.ptp(z))
    if not span:
        raise ConfigError(f"is {z[0]:g} m in every row; give a curve that moves", "position")
    base = z if curve.stiffness is None else _base(z, f, curve.stiffness)
    _check_rise(base, f)
    if t is None and curve.speed is not None:
        t = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(base)))]) / curve.speed
    rows = _rows(base, segment, messages)
    z, f, base, t = z[rows], f[rows], base[rows], None if t is None else t[rows]
    _check_count(z, "it" if segment == "both" else f"its {segment}")
    if segment != "both":
        # The position of a tip holds the noise of the force: sorted by it, the noise has a slope.
        order = np.argsort(base, kind="stable")
        z, f, t = z[order], f[order], None if t is None else t[order]
    if z.size < _FEW:
        messages.append(f"only {z.size} points: expect wide intervals")
    if np.unique(z).size < FEWEST:
        raise ConfigError(
            f"has {np.unique(z).size} different values; give at least {FEWEST}", "position"
        )
    return replace(curve, position=z, force=f, time=t, speed=None, messages=tuple(messages))


def grows(time: Array) -> bool:
    """Return whether times are finite, never fall, and are not all the same."""
    if not np.isfinite(time).all():
        return False
    steps = np.diff(time)
    return bool((steps >= 0).all() and steps.any())


def _time(values: Array, rows: Mask) -> Array:
    """Return the time of some rows; an error names what is wrong with it."""
    time = _array(values, "time")
    if time.shape != rows.shape:
        raise ConfigError(f"has {time.size} values; give one for each of {rows.size} rows", "time")
    time = time[rows]
    if not grows(time):
        raise ConfigError(
            "falls, stands still or holds no finite number; give the time of each row [s] in order",
            "time",
        )
    return time


def _array(values: ArrayLike, name: str) -> Array:
    if np.iscomplexobj(values):
        raise ConfigError("holds complex numbers; give real values in SI", name)
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise ConfigError(
            f"{shown(values)} is not a list of numbers; give SI values", name
        ) from None
    if array.ndim != 1:
        raise ConfigError(f"is of shape {array.shape}; give a list, one curve at a time", name)
    return array


def _base(z: Array, f: Array, stiffness: float) -> Array:
    """Return the position of the cantilever's base [m]."""
    slope = float(np.ptp(f)) / float(np.ptp(z))
    if not 1 / _LARGEST_RATIO <= slope / stiffness <= _LARGEST_RATIO:
        raise ConfigError(
            f"of {readable(stiffness, 'N/m', 3)} is far from the {readable(slope, 'N/m', 3)} of "
            "this curve itself, so "
            "that deflection and position differ by orders of magnitude; give that of the "
            "cantilever with its unit",
            "spring_constant",
        )
    return z + f / stiffness


def _check_si(values: Array, name: str, unit: str) -> None:
    """Raise if values are too large or too small to be in SI units."""
    largest = float(np.max(np.abs(values)))
    if largest and not 1 / LARGEST <= largest <= LARGEST:
        raise ConfigError(
            f"reaches {largest:.3g} {unit}, and must reach between {1 / LARGEST:g} and "
            f"{LARGEST:g} {unit}: give SI values",
            name,
        )


def _check_count(z: Array, rows: str) -> None:
    if z.size < FEWEST:
        raise ConfigError(f"{rows} has {z.size} points; a fit needs at least {FEWEST}", "position")


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
            "one of them",
            "force",
        )
    if rise <= least or not rise:
        raise ConfigError(
            f"does not rise with the position (by {readable(rise, 'N', 2)} at a noise of "
            f"{readable(noise, 'N', 2)}): there "
            "is no contact in the curve; give one that goes deeper",
            "force",
        )


def _rows(z: Array, segment: Segment, messages: list[str]) -> slice:
    """Return the rows of the first pass into the solid, or out of it, or of both."""
    turns = _turns(z, _TURN * float(np.ptp(z)))
    passes = list(zip([0, *turns], [*turns, z.size - 1], strict=True))
    inward = [bool(z[last] > z[first]) for first, last in passes]
    if len(passes) > 2:
        raise ConfigError(
            f"goes to and fro {len(passes)} times: several curves, or rows out of order; give one "
            "curve at a time, its rows in order",
            "position",
        )
    if segment == "both":
        if inward not in ([True], [True, False]):
            raise ConfigError(
                "does not begin with an approach, and both passes are to be fitted; give the rows "
                "in order of time, or set segment to the pass that there is",
                "position",
            )
        return slice(0, z.size)
    approach = segment == "approach"
    if approach not in inward:
        article, other = ("a", "retract") if approach else ("an", "approach")
        raise ConfigError(
            f"only moves {'out of' if approach else 'into'} the solid: this is {article} {other}, "
            f"and the {segment} is to be fitted; give the {segment}, or set segment to {other!r}",
            "position",
        )
    first, last = passes[inward.index(approach)]
    # Rows of a dwell at the turn precede the retract.
    while first and z[first + 1] == z[first]:
        first += 1
    first, last = _without_pause(z, first, last, approach)
    if left_out := z.size - 1 - last + first:
        messages.append(
            Note(
                f"rows {first + 1} to {last + 1} are the {segment}; the other {left_out} were left "
                "out"
            )
        )
    if not approach:
        messages.append("a retract is fitted as if nothing adhered: compare with the approach")
    return slice(first, last + 1)


def _without_pause(z: Array, first: int, last: int, approach: bool) -> tuple[int, int]:
    """Return the first and the last row of a pass without a pause at its deep end.

    In a pause the position creeps or is only noise; the rows of an approach and its pause are split
    into blocks, and those that move by less than a tenth of what the fast ones do are the pause.
    """
    rows = z[first : last + 1] if approach else z[first : last + 1][::-1]
    size = rows.size // _BLOCKS
    if size < _BLOCK_ROWS:
        return first, last
    blocks = rows[rows.size - size * _BLOCKS :].reshape(_BLOCKS, size)
    centred = np.arange(size) - (size - 1) / 2
    speed = np.abs(blocks @ centred)
    slow = speed < _SLOW * np.quantile(speed, _FAST_QUANTILE)
    count = int(np.argmin(slow[::-1])) if not slow.all() else 0
    if count < _PAUSE_BLOCKS:
        return first, last
    begin, later = np.median(blocks[-count : 2 - count], axis=1)
    # The block before holds rows of the ramp and, at most one block of creep earlier, of the pause.
    end = int(np.argmax(rows >= begin - 1.5 * max(later - begin, 0.0)))
    return (first, first + end) if approach else (last - end, last)


def _turns(z: Array, least: float) -> list[int]:
    """Return the rows after which the position moves the other way by ``least`` or more."""
    turns: list[int] = []
    low = high = 0
    direction = 0
    for row, value in enumerate(z.tolist()):
        if value > z[high]:
            high = row
        if value < z[low]:
            low = row
        if direction >= 0 and z[high] - value >= least:
            if direction:
                turns.append(high)
            direction, low = -1, row
        elif direction <= 0 and value - z[low] >= least:
            if direction:
                turns.append(low)
            direction, high = 1, row
    return turns
