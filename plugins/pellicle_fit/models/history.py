"""The path of an indenter in time, smoothed, for solids that remember it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array, Mask

_BINS = 60
"""Largest number of nodes of a smoothed pass."""
_LEAST = 8
"""Least number of rows that a node averages, if there are as many."""
_NORMAL = 1.4826 / np.sqrt(6)
"""Standard deviation of noise over the median size of its second differences."""
_WILD = 4.0
"""Standard deviations of noise below the largest position within which the indenter dwells."""
_DWELL = 0.02
"""Distance from the largest position, over the range, within which the indenter dwells."""
_RESTS = 0.1
"""Share of the time of loading from which on the end of a pass is a dwell."""


@dataclass(frozen=True, eq=False)
class History:
    """Path of an indenter: loading, a dwell perhaps, and unloading; positions grow into the solid.

    Measured positions hold noise, so each pass is a chain of straight lines between averages.
    """

    time: Array
    """Time of each row [s], of shape (n,)."""
    unloading: Mask
    """Whether a row is taken while the indenter moves out, of shape (n,)."""
    velocity: Array
    """Velocity of the indenter into the solid [m/s] at each row, of shape (n,)."""
    loading_path: tuple[Array, Array]
    """Times [s] and positions [m] of the nodes of loading and dwell, both not decreasing."""
    unloading_path: tuple[Array, Array]
    """The same of unloading; positions do not increase.  Empty if there is none."""
    top: float
    """Time [s] at which the dwell begins; that of the last node of loading without one."""

    @classmethod
    def of(cls, position: Array, time: Array) -> History:
        """Return the history of rows in any order, with positions [m] and times [s]."""
        order = np.argsort(time, kind="stable")
        z, t = position[order], time[order]
        turn = last_row_of_loading(z)
        down = chain(t[: turn + 1], z[: turn + 1])
        up = chain(t[turn + 1 :], z[turn + 1 :])
        loading = (down[0], np.maximum.accumulate(down[1]))
        unloading = (up[0], np.minimum.accumulate(up[1]))
        if up[0].size:
            # The passes join where the indenter turns.
            unloading = (
                np.concatenate([loading[0][-1:], up[0]]),
                np.minimum.accumulate(np.concatenate([loading[1][-1:], up[1]])),
            )
        mask = np.zeros(z.size, dtype=bool)
        velocity = np.empty(z.size)
        mask[order[turn + 1 :]] = True
        velocity[order] = np.concatenate(
            [_slope(loading, t[: turn + 1]), _slope(unloading, t[turn + 1 :])]
        )
        deepest = loading[1][-1]
        near = loading[1] >= deepest - _DWELL * (deepest - loading[1][0])
        return cls(time, mask, velocity, loading, unloading, float(loading[0][np.argmax(near)]))

    @property
    def dwells(self) -> bool:
        """Whether the indenter rests for more than a tenth of the time in which it moves in."""
        times, _ = self.loading_path
        return bool(times[-1] - self.top > _RESTS * (self.top - times[0]))

    def at_rows(self, rows: NDArray[np.intp]) -> History:
        """Return the same path with some of the rows."""
        return replace(
            self,
            time=self.time[rows],
            unloading=self.unloading[rows],
            velocity=self.velocity[rows],
        )

    def contact_time(self, contact_point: float) -> float:
        """Return when the indenter passes a position on loading; extrapolated before the first."""
        times, positions = self.loading_path
        if contact_point >= positions[0]:
            return float(np.interp(contact_point, positions, times))
        rise = max(float(np.ptp(positions)), float(np.finfo(float).tiny))
        return float(times[0] - (positions[0] - contact_point) * np.ptp(times) / rise)

    def positions(self, times: Array, contact_point: float) -> Array:
        """Return positions [m] of loading at times [s], from the contact point on."""
        start = self.contact_time(contact_point)
        t, z = self.loading_path
        later = t > start
        path: Array = np.interp(
            times,
            np.concatenate([[start], t[later]]),
            np.concatenate([[contact_point], np.maximum(z[later], contact_point)]),
        )
        return path


def last_row_of_loading(position: Array) -> int:
    """Return the last row before the indenter moves out, of positions in order of time."""
    largest = float(position.max())
    # A dwell holds noise, so that its largest position may be anywhere in it.
    bends = np.abs(np.diff(position, 2))
    noise = _NORMAL * float(np.median(bends)) if bends.size else 0.0
    return int(np.flatnonzero(position >= largest - _WILD * noise)[-1])


def constant_speed(position: Array) -> Array:
    """Return times [s] at which rows in order of time are taken at constant speed.

    The loading takes 1 s, and rows of a dwell follow each other at once.
    """
    turn = last_row_of_loading(position)
    span = max(float(position[turn] - position[0]), float(np.finfo(float).tiny))
    down = np.maximum.accumulate((position[: turn + 1] - position[0]) / span)
    up = np.maximum.accumulate(np.maximum((position[turn] - position[turn + 1 :]) / span, 0.0))
    return np.concatenate([down, down[-1] + up])


def chain(time: Array, position: Array) -> tuple[Array, Array]:
    """Return the averages of groups of neighbouring rows, with the first and the last row's."""
    if not time.size:
        return time, position
    groups = max(min(_BINS, time.size // _LEAST), min(time.size, 2))
    edges = np.linspace(0, time.size, groups + 1).astype(int)
    counts = np.diff(edges)
    t, z = (np.add.reduceat(values, edges[:-1]) / counts for values in (time, position))
    ends = []
    for row, first, second in ((0, 0, 1), (-1, -1, -2)):
        if groups < 2 or t[first] == t[second]:
            ends.append(z[first])
            continue
        slope = (z[first] - z[second]) / (t[first] - t[second])
        ends.append(z[first] + slope * (time[row] - t[first]))
    return (
        np.concatenate([time[:1], t, time[-1:]]),
        np.concatenate([ends[:1], z, ends[1:]]),
    )


def _slope(path: tuple[Array, Array], times: Array) -> Array:
    """Return the derivative of a path at times."""
    t, z = path
    if not t.size:
        return np.zeros_like(times)
    keep = np.concatenate([[True], np.diff(t) > 0])
    t, z = t[keep], z[keep]
    if t.size < 2:
        return np.zeros_like(times)
    rates = np.diff(z) / np.diff(t)
    slopes: Array = rates[np.clip(np.searchsorted(t, times, side="right") - 1, 0, rates.size - 1)]
    return slopes
