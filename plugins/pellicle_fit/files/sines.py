"""The sines of a measured curve, read apart from its slow course."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.special import ndtri, stdtrit

from pellicle.arrays import Array
from pellicle.errors import ConfigError
from pellicle.units import decimal, readable
from pellicle_fit.sine import Sine

from .measurement import Note

_FINE = 16
"""Points of a cycle at which a sine is sought."""
_WIDTH = 2.0
"""Cycles of a frequency, and of its distance to the nearest other, that are seen at once."""
_STEADY = 0.2
"""Change over a cycle, over itself, of an amplitude that is one of a sine."""
_EDGE = 0.75
"""Share of what is seen at once by which the middle of a sine is longer than where it is steady."""
_FEWEST_CYCLES, _FEWEST_ROWS = 3.0, 5.0
"""Least number of whole cycles of a sine, and of rows in a cycle."""
_DENSEST, _DENSER = 0.01, 100.0
"""Quantile of the steps of time that is the shortest, and how much longer their mean may be."""
_OFF, _CLEAR = 0.1, 10.0
"""Part by which another frequency is off, and amplitude over noise of what is no noise."""
_TAIL = 0.975
"""Below which probability the upper end of an interval lies."""
_REFINED = 2
"""Steps towards the exact frequency of a sine, each of which leaves the square of the error."""
_LEAVES = 0.3
"""Distance from a sine that goes on, over its amplitude, at which it has ended."""
_DEGREE = 6
"""Greatest degree of the slow course beside a sine, which has fewer than there are cycles."""
_NEAR, _NEIGHBOURS = 2, 20
"""Lines of the spectrum beside a sine that may hold some of it; those from which its noise is told,
on each side."""


class _Harmonics(NamedTuple):
    """A sine of base and force where it is steady."""

    base: complex
    force: complex
    deviations: tuple[float, float]
    """Standard deviation of the parts of both."""
    sines: Array
    """What oscillates in base and force, of shape (2, rows)."""
    levels: Array
    """The slow course of the base at the first and at the last row, of shape (2,)."""
    slopes: Array
    """Its velocity over the first and over the last cycle [m/s], of shape (2,)."""


class _Span(NamedTuple):
    """When a sine is steady."""

    frequency: float
    ends: tuple[float, float]
    """From and to when [s]."""
    reach: float
    """Time [s] within which it begins and ends beyond these."""

    def overlaps(self, other: _Span) -> bool:
        """Return whether another sine is steady for a part of the time."""
        begin, end = other.ends
        return begin < self.ends[1] and end > self.ends[0] and other.frequency != self.frequency


class _SteadySine(NamedTuple):
    """A sine in rows where it and, if that is for long, all others at the time are steady."""

    span: _Span
    rows: NDArray[np.intp]
    parts: _Harmonics

    def at(self, time: Array, rows: NDArray[np.intp]) -> Array:
        """Return the base [m] in some rows of the curve, at times of all, if it goes on there."""
        middle = (time[self.rows[0]] + time[self.rows[-1]]) / 2
        turn = np.exp(2j * np.pi * self.span.frequency * (time[rows] - middle))
        return np.asarray((self.parts.base * turn).real)


class SineSeparation(NamedTuple):
    """A curve without its sines, and these."""

    position: Array
    """Of the rows that are left [m]."""
    force: Array
    """Of the same [N]."""
    rows: NDArray[np.intp]
    """Which rows are left."""
    sines: tuple[Sine, ...]
    notes: tuple[Note, ...]


def separate(
    position: Array,
    force: Array,
    time: Array | None,
    stiffness: float | None,
    frequencies: Sequence[float],
    lag: float,
) -> SineSeparation:
    """Return a curve without its sines of some frequencies [Hz], and these beside it.

    The rows are in order of time.  The force may be read a ``lag`` [s] after the position.  What is
    left of a hold is its slow course; rows in which a sine begins or ends are left out.

    Raises
    ------
    ConfigError
        The curve has no time, or a sine is not found.
    """
    if time is None:
        raise ConfigError("need the time of each row; give a column of time", "frequencies")
    steps = np.diff(time)
    shortest = max(float(np.quantile(steps, _DENSEST)), float(np.mean(steps)) / _DENSER)
    most = 1 / (_FEWEST_ROWS * shortest)
    if (fastest := max(frequencies)) > most:
        raise ConfigError(_too_fast(fastest, most), "frequencies")
    softness = 1 / stiffness if stiffness else 0.0
    base = position + softness * force
    spans = [_steady(time, base, f, frequencies) for f in frequencies]
    measured = np.array([base, force])
    slow, sines, steady = measured.copy(), list[Sine](), list[_SteadySine]()
    for frequency, span in zip(frequencies, spans, strict=True):
        beside = [other for other in spans if span.overlaps(other)]
        first, last = _common(span, beside)
        rows = np.flatnonzero((time >= first) & (time <= last))
        if rows.size < _FEWEST_ROWS * span.frequency * (last - first):
            most = rows.size / (last - first) / _FEWEST_ROWS
            raise ConfigError(_too_fast(frequency, most), "frequencies")
        at_once = [other.frequency for other in beside]
        exact = _refined(time[rows], base[rows], span.frequency, at_once)
        found = _harmonics(time[rows], measured[:, rows], exact, at_once)
        if abs(found.base) < _CLEAR * found.deviations[0]:
            reason = "what oscillates is no more than noise"
            raise ConfigError(_absent(frequency, reason), "frequencies")
        slow[:, rows] -= found.sines
        told, deviation, amplitude = _stiffness(found, np.exp(2j * np.pi * exact * lag), softness)
        z, f, t = (float(np.mean(values[rows])) for values in (position, force, time))
        ends = rows[[0, -1]].tolist()
        sines.append(Sine(exact, amplitude, told, deviation, z, f, t, *ends))
        steady.append(_SteadySine(span._replace(frequency=exact), rows, found))
    partly = np.zeros(time.size, bool)
    for sine in steady:
        others = [other for other in steady if sine.span.overlaps(other.span)]
        begin, end = _ends(time, slow[0], sine, others)
        partly[begin : sine.rows[0]] = partly[sine.rows[-1] + 1 : end + 1] = True
    left = np.flatnonzero(~partly)
    listed = ", ".join(f"{s.frequency:.4g}" for s in sines)
    lagging = f"; a lag of the force of {readable(lag, 's', 3)} is taken off" if lag else ""
    notes = (
        Note(f"sines of {listed} Hz were read apart from the curve{lagging}"),
        _of_a_row(sines, time),
    )
    # The base has no noise, so it is what is shifted.
    load, way = slow[1, left], np.interp(time - lag, time, slow[0])[left]
    return SineSeparation(way - softness * load, load, left, tuple(sines), notes)


def _common(span: _Span, beside: Sequence[_Span]) -> tuple[float, float]:
    """Return from and to when all others beside a sine are steady as well, if long enough."""
    begins, ends = zip(*(of.ends for of in (span, *beside)), strict=True)
    begin, end = max(begins), min(ends)
    return (begin, end) if (end - begin) * span.frequency >= _FEWEST_CYCLES else span.ends


def _steady(time: Array, base: Array, frequency: float, frequencies: Sequence[float]) -> _Span:
    """Return the exact frequency [Hz] of a sine, when it is steady from and to, and a reach [s].

    Half the difference of a position and the mean of those half a cycle before and after has the
    sine and no ramp.  Its amplitude is steady where the sine is, and nowhere else for long.
    """
    others = [abs(f - frequency) for f in frequencies if f != frequency]
    reach = _WIDTH / min([frequency, *others])
    at = np.arange(time[0], time[-1], 1 / (_FINE * frequency))
    half, size = _FINE // 2, 2 * (int(reach * frequency * _FINE) // 2) + 1
    if at.size < size + 2 * _FINE:
        raise ConfigError(_absent(frequency, "the curve is too short for it"), "frequencies")
    z = np.interp(at, time, base)
    rest = (z[half:-half] - (z[: -2 * half] + z[2 * half :]) / 2) / 2
    at = at[half:-half]
    window = np.hanning(size + 2)[1:-1]
    seen = rest * np.exp(-2j * np.pi * frequency * at)
    amplitude = 2 * np.convolve(seen, window / window.sum(), "valid")
    at = at[size // 2 : size // 2 + amplitude.size]
    change = np.abs(amplitude[_FINE:] - amplitude[:-_FINE])
    is_steady = change < _STEADY * np.abs(amplitude[_FINE:])
    ends = np.flatnonzero(np.diff(np.concatenate([[False], is_steady, [False]])))
    runs = [
        (first, last + _FINE)
        for first, last in zip(ends[::2], ends[1::2], strict=True)
        if (last - first) / _FINE >= 1
    ]
    if not runs:
        raise ConfigError(_absent(frequency, "nothing oscillates steadily"), "frequencies")
    first, last = max(runs, key=lambda run: float(np.sum(np.abs(amplitude[run[0] : run[1]]))))
    # Of an amplitude that is steady but small beside the largest of its run it is the edge.
    of_run = np.abs(amplitude[first:last])
    inside = first + np.flatnonzero(of_run > of_run.max() / 2)
    first, last = inside[0], inside[-1]
    phase = np.unwrap(np.angle(amplitude[first : last + 1]))
    slope = float(np.polyfit(at[first : last + 1], phase, 1)[0]) if last > first else 0.0
    exact = frequency + slope / (2 * np.pi)
    longer = max(_EDGE * reach / 2 - 1 / frequency, 0.0)
    begin, end = float(at[first] - longer), float(at[last] + longer)
    begin, end = max(begin, float(time[0])), min(end, float(time[-1]))
    if abs(exact - frequency) > _OFF * frequency:
        raise ConfigError(_absent(frequency, "nothing oscillates steadily"), "frequencies")
    if (end - begin) * frequency < _FEWEST_CYCLES:
        raise ConfigError(_absent(frequency, "it has fewer than three cycles"), "frequencies")
    return _Span(exact, (begin, end), reach)


def _too_fast(frequency: float, most: float) -> str:
    return (
        f"{frequency:g} Hz has fewer than {_FEWEST_ROWS:g} rows in a cycle; give those up to "
        f"{most:.3g} Hz"
    )


def _absent(frequency: float, reason: str) -> str:
    return (
        f"no sine of {frequency:g} Hz was found in the position: {reason}; give the frequencies at "
        "which the instrument oscillates, or leave them out"
    )


def _refined(time: Array, base: Array, frequency: float, beside: Sequence[float]) -> float:
    """Return a frequency [Hz] whose sine keeps its phase along the base, beside others."""
    t = time - (time[0] + time[-1]) / 2
    for _ in range(_REFINED):
        turns = np.exp(2j * np.pi * np.array([[frequency, *beside]]).T * t)
        waves = [w for u in turns for w in (u.real, u.imag, t * u.real, t * u.imag)]
        design = np.column_stack([*waves, legendre.legvander(t / t[-1], 2)])
        weights, *_ = np.linalg.lstsq(design / abs(design).max(axis=0), base, rcond=None)
        weights = weights / abs(design).max(axis=0)
        size, rate = complex(weights[0], -weights[1]), complex(weights[2], -weights[3])
        frequency += (rate / size).imag / (2 * np.pi)
    return frequency


def _ends(
    time: Array, slow: Array, sine: _SteadySine, others: Sequence[_SteadySine]
) -> tuple[int, int]:
    """Return the first and the last row in which a sine may stand.

    Beyond them the base without sines where they are steady, ``slow``, leaves the one that goes on,
    whether all others do, or none, one or all but one of them.
    """
    ends = []
    parts = sine.parts
    for i, (way, level, slope) in enumerate(zip((-1, 1), parts.levels, parts.slopes, strict=True)):
        row = sine.rows[-i]
        beyond = np.arange(row + way, -1 if way < 0 else time.size, way)
        beyond = beyond[way * (time[beyond] - sine.span.ends[i]) < sine.span.reach]
        off = slow[beyond] - level - slope * (time[beyond] - time[row]) - sine.at(time, beyond)
        none = np.zeros(beyond.size)
        # What is left of others where they are not steady.
        of_others = [
            np.where((beyond < o.rows[0]) | (beyond > o.rows[-1]), o.at(time, beyond), none)
            for o in others
        ]
        of_all = np.sum([none, *of_others], axis=0)
        going_on = [none, of_all, *of_others, *(of_all - of for of in of_others)]
        off = np.abs(off - going_on).min(axis=0)
        leaves = np.flatnonzero(off > _LEAVES * abs(parts.base))
        ends.append(int(row + way * (leaves[0] if leaves.size else beyond.size)))
    return ends[0], ends[1]


def _harmonics(
    time: Array, measured: Array, frequency: float, beside: Sequence[float]
) -> _Harmonics:
    """Return a sine of base and force, of shape (2, rows), beside others and a slow course."""
    middle, half = (time[0] + time[-1]) / 2, (time[-1] - time[0]) / 2
    cycles = 2 * half * frequency
    degree = int(min(_DEGREE, cycles // 2))
    course = legendre.legvander((time - middle) / half, degree)
    # A second harmonic is its own, unless another sine stands there.
    own = [f for f in (frequency, 2 * frequency) if all(abs(f - g) > 1 / half for g in beside)]
    turns = [np.exp(2j * np.pi * f * (time - middle)) for f in (*own, *beside)]
    waves = np.column_stack([part for turn in turns for part in (turn.real, turn.imag)])
    design = np.column_stack([waves, course])
    weights, *_ = np.linalg.lstsq(design, measured.T, rcond=None)
    residual = measured.T - design @ weights
    freedom = time.size / max(time.size - design.shape[1], 1)
    base, force = (complex(w[0], -w[1]) for w in weights.T)
    deviations = [_deviation(time, r, frequency, beside) * freedom**0.5 for r in residual.T]
    count = 2 * len(own)
    oscillates = (waves[:, :count] @ weights[:count]).T
    course_of_base = course @ weights[waves.shape[1] :, 0]
    ends, cycle = time[[0, -1]], np.array([1.0, -1.0]) / frequency
    levels, inside = course_of_base[[0, -1]], np.interp(ends + cycle, time, course_of_base)
    slopes = (inside - levels) / cycle
    return _Harmonics(base, force, (deviations[0], deviations[1]), oscillates, levels, slopes)


def _deviation(time: Array, residual: Array, frequency: float, beside: Sequence[float]) -> float:
    """Return the standard deviation of the parts of a sine, from the spectrum beside it.

    It is at least that of white noise, of which few lines tell less, and wider by Student's t, as
    the lines are few.
    """
    line = 1 / (time[-1] - time[0])
    steps = np.arange(_NEAR, _NEAR + _NEIGHBOURS)
    near = frequency + line * np.concatenate([-steps, steps])
    others = np.array([2 * frequency, *beside])
    free = np.all(np.abs(near[:, None] - others) > _NEAR * line, axis=1)
    fastest = 0.5 * time.size * line
    near = near[free & (near > _NEAR * line) & (near < fastest)]
    turns = np.exp(-2j * np.pi * near[:, None] * time)
    parts = 2 / time.size * (turns @ residual)
    of_white = float(np.sqrt(2 * np.mean(residual**2) / time.size))
    if not near.size:
        return of_white
    wider = float(stdtrit(2 * near.size, _TAIL) / ndtri(_TAIL))
    return wider * max(float(np.sqrt(np.mean(np.abs(parts) ** 2) / 2)), of_white)


def _stiffness(found: _Harmonics, turn: complex, softness: float) -> tuple[complex, float, float]:
    """Return the stiffness [N/m] of a sine, the deviation of its parts, and the amplitude [m].

    The force is turned by ``turn`` for its lag.
    """
    load = found.force * turn
    way = found.base - softness * load
    stiffness = load / way
    # ∂K/∂F = (1 + K/k)/δ and ∂K/∂z = −K/δ.
    of_base, of_force = found.deviations
    deviation = np.hypot(abs(1 + softness * stiffness) * of_force, abs(stiffness) * of_base)
    return stiffness, float(deviation) / abs(way), abs(way)


def _of_a_row(sines: Sequence[Sine], time: Array) -> Note:
    """Return what a lag of a row would change."""
    fastest = max(sines, key=lambda sine: sine.frequency)
    step = (time[fastest.last] - time[fastest.first]) / (fastest.last - fastest.first)
    turn = decimal(360 * fastest.frequency * float(step), 2)
    text = f"a force that is read one row late turns the phase at {fastest.frequency:.4g} Hz by"
    return Note(f"{text} {turn} degrees: give the lag, if there is one")
