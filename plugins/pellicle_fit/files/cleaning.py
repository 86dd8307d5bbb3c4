"""The rows of a measured curve that are fitted, checked and in order of time."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pellicle.arrays import Array
from pellicle.errors import ConfigError, excerpt
from pellicle.units import readable
from pellicle_fit.sine import Sine

from .measurement import Measurement, Note, Segment
from .passes import order_of_time, passes, rows_of
from .sines import separate

_FEWEST, _FEW = 8, 30
"""Least number of points of a fit, and the least that need no warning."""
_SIGNIFICANT = 4.0
"""Standard errors that the rise of the force must exceed."""
_MODULATED = 0.1
"""Share of the range by which a pass moves back, if that is told."""
_LARGEST = 1e30
"""Largest size of what is measured, in SI; its inverse bounds how little it varies."""


def clean(
    curve: Measurement,
    segment: Segment = "approach",
    frequencies: Sequence[float] = (),
    lag: float = 0.0,
) -> Measurement:
    """Return the rows of one pass into the solid (or out of it), or of both, in order of time.

    Sines of some ``frequencies`` [Hz], whose force may ``lag`` [s], are read apart.

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
    missing = int(np.sum(~finite))
    if missing:
        messages.append(Note(f"{missing} of {z.size} rows hold no finite number and were left out"))
    which = f"without {missing} rows that hold no finite number, the curve"
    _check_count(int(finite.sum()), which if missing else "the curve")
    for name, values, unit in (("position", z, "m"), ("force", f, "N"), ("time", t, "s")):
        if values is not None:
            _check_size(name, values, unit)
    number = np.flatnonzero(finite)
    if t is not None and (order := order_of_time(t[finite], z[finite], segment)) is not None:
        number = number[order]
        messages.append(Note("the rows were put in order of time"))
    z, f, t = z[number], f[number], None if t is None else t[number]
    if t is not None and not (np.isfinite(t).all() and np.all(np.diff(t) >= 0) and np.ptp(t)):
        reason = "falls, stands still or has a row without a number"
        messages.append(f"the time {reason}, so the curve is taken as one without time")
        t = None
    sines: tuple[Sine, ...] = ()
    if frequencies:
        found = separate(z, f, t, curve.stiffness, frequencies, lag)
        rows_of_file = [number[[sine.first, sine.last]] + 1 for sine in found.sines]
        sines = tuple(
            sine._replace(first=int(ends[0]), last=int(ends[1]))
            for sine, ends in zip(found.sines, rows_of_file, strict=True)
        )
        z, f, number = found.position, found.force, number[found.rows]
        t = None if t is None else t[found.rows]
        messages += found.notes
    pause = None
    if curve.pause is not None:
        pause = np.asarray(curve.pause)[number]
        _check_count(int(np.sum(~pause)), "the curve without its pauses")
    if not np.ptp(z):
        raise ConfigError(f"is {z[0]:g} m in every row; give a curve that moves", "position")
    base = z if curve.stiffness is None else z + f / curve.stiffness
    _check_rise(base, f)
    if t is None and curve.speed is not None:
        t = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(base)))]) / curve.speed
    segments = passes(base, pause)
    first, last, unloading = rows_of(base, segments, segment)
    rows = np.arange(first, last + 1)
    if pause is not None and segment in ("approach", "retract"):
        rows = rows[~pause[rows]]
    elif pause is not None and segment == "both" and len(segments) > 1:
        unloading = segments[1].first
    if left := z.size - rows.size:
        which = "both passes" if segment == "both" else f"the {segment.replace('+', ' and ')}"
        of = f"rows {_spans(number, rows)} are {which}"
        others = np.delete(np.arange(z.size), rows)
        messages.append(Note(f"{of}; the other {left} ({_spans(number, others)}) were left out"))
    way = -base[rows] if segment == "retract" else base[rows]
    back = float(np.max(np.maximum.accumulate(way) - way))
    if segment != "both" and back > _MODULATED * np.ptp(base):
        text = f"the position moves back by up to {readable(back, 'm', 2)} within the {segment}"
        messages.append(Note(f"{text}, which is fitted as one pass"))
    is_later = segment in ("approach", "approach+hold") and segments[-1].first >= last
    later = number[segments[-1].first : segments[-1].last + 1]
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
        sines=sines,
        messages=tuple(messages),
        left_out=(int(later.min()) + 1, int(later.max()) + 1) if is_later else None,
        unloading=rows >= unloading,
        pause=None if pause is None else pause[rows],
    )


def _spans(number: NDArray[np.intp], rows: NDArray[np.intp]) -> str:
    """Return rows by their numbers in the file, from 1, as spans of those that are there."""
    own = np.isin(place := np.sort(number), number[rows])
    ends = np.flatnonzero(np.diff(np.concatenate([[False], own, [False]])))
    pairs = zip(place[ends[::2]] + 1, place[ends[1::2] - 1] + 1, strict=True)
    return " and ".join(f"{first} to {last}" for first, last in pairs)


def _array(values: ArrayLike, name: str) -> Array:
    if isinstance(values, np.ma.MaskedArray):
        values = np.ma.filled(values.astype(float), np.nan)
    with suppress(TypeError, ValueError, OverflowError), np.errstate(over="ignore"):
        if not np.iscomplexobj(values) and (array := np.asarray(values, dtype=float)).ndim == 1:
            return array
    raise ConfigError(
        f"{excerpt(values)} is not a list of real numbers; give SI values, one curve at a time",
        name,
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
    # Where nearly all rows rest in a hold, few are of the approach.
    below = int(np.sum(z < (z.min() + z.max()) / 2))
    low, high = f[order[: min(tenth, below)]], f[order[-min(tenth, z.size - below) :]]
    rise = float(high.mean() - low.mean())
    # Neighbours differ by the noise and by the slope, so this is an upper bound of the noise.
    noise = float(np.sqrt(np.mean(np.diff(f[order]) ** 2) / 2))
    least = _SIGNIFICANT * noise * np.sqrt(1 / low.size + 1 / high.size)
    # The wrong sign has no force above that before contact.
    if rise < -least and f.max() - low.mean() > -rise / 2:
        raise ConfigError(
            f"falls by {readable(-rise, 'N', 3)} over the deepest tenth, and pushes in some rows "
            "only: the tip jumps into contact and sticks over most of it; give a curve that goes "
            "deeper",
            "force",
        )
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
