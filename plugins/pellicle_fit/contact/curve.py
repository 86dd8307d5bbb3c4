"""The record of one measured curve, as fits see it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array, Mask
from pellicle.components import HasForceCurve
from pellicle.errors import ConfigError
from pellicle_fit.sine import Sine

from .contact import Contact

_BRIEFEST = 0.01
"""Least time in contact over that of the approach."""
_DEEP, _LASTS = 0.02, 0.1
"""Distance of a dwell from the deepest row, over the range, and its least part of the loading."""
_SHALLOW = 10
"""One in how many rows is among the shallowest, whose force is taken for that without a load."""
_NEIGHBOURS = 4
"""Rows on each side over which forces are smoothed."""
_CLEAR, _WAYS = 0.2, 3.0
"""Part of the forces that is no noise, and the way that touches over that beyond it."""
BEFORE = 6.0
"""How far before the first row a contact may lie, over the range of positions."""
_COARSE = 60
"""Means for each pass that rough searches see."""


@dataclass(frozen=True, eq=False)
class Curve:
    """Forces on an indenter along its path, rows in order of time, in SI."""

    position: Array
    """Position of the indenter [m], growing into the solid, of shape (n,)."""
    force: Array
    """Force [N], positive where the solid pushes."""
    indenter: HasForceCurve
    """An indenter with a force curve on a half-space under tension."""
    time: Array | None = None
    """Time of each row [s]; None if it is not known."""
    unloading: Mask | None = None
    """Whether a row is taken while the indenter moves out; by default, after the deepest row."""
    stiffness: float | None = None
    """Spring constant of the cantilever [N/m]; None if it is stiff or not known."""
    touch: float | None = None
    """Contact point [m] if it is given: as a position that is read, which an offset shifts."""
    counts: Array | None = None
    """How many measured rows each row is the mean of; None if one."""
    is_rough: bool = False
    """Whether it only has to tell where a minimum is."""
    sines: tuple[Sine, ...] = ()
    """What oscillates beside the rows."""

    @cached_property
    def base(self) -> Array:
        """Position of the cantilever's base [m], which is exact where that of the tip is noisy."""
        return self.position + self.force / self.stiffness if self.stiffness else self.position

    @cached_property
    def shallow_force(self) -> float:
        """Force where the base is shallowest [N], as before contact if any row is."""
        count = max(self.force.size // _SHALLOW, 1)
        return float(np.median(self.force[np.argpartition(self.base, count - 1)[:count]]))

    @property
    def clock(self) -> Array:
        """Time of each row [s], for effects that excuse themselves without it."""
        if self.time is None:
            raise ConfigError("is missing; give the time of each row, or a speed", "time")
        return self.time

    @cached_property
    def loading_time(self) -> float:
        """Time of the approach [s]; that of the retraction if there is nothing else."""
        return float(np.ptp(self.clock[self.first_pass])) if self.time is not None else 1.0

    def time_in_contact(self, contact_point: float) -> float:
        """Return the time [s] from a first touch at a position [m] to the end of the approach."""
        time, base = self.clock[self.first_pass], np.maximum.accumulate(self.base[self.first_pass])
        touched = float(np.interp(contact_point, base, time))
        return float(max(time[-1] - touched, _BRIEFEST * self.loading_time))

    @cached_property
    def moves_out(self) -> Mask:
        """Whether a row is taken while the indenter moves out."""
        if self.unloading is not None:
            return self.unloading
        return np.arange(self.position.size) > int(np.argmax(self.position))

    @cached_property
    def first_pass(self) -> Mask:
        """Rows of the approach, or of the retraction if there is nothing else."""
        return ~self.moves_out if not np.all(self.moves_out) else self.moves_out

    @cached_property
    def passes(self) -> list[NDArray[np.intp]]:
        """The rows of each pass, that of the approach first."""
        return [np.flatnonzero(rows) for rows in (~self.moves_out, self.moves_out) if rows.any()]

    @cached_property
    def rests(self) -> Mask:
        """Rows of a dwell: the deepest on the way in, if they last for a tenth of it."""
        deep = ~self.moves_out & (self.base >= self.base.max() - _DEEP * float(np.ptp(self.base)))
        lasts = deep.any() and np.ptp(self.clock[deep]) > _LASTS * self.loading_time
        return deep if lasts else np.zeros_like(deep)

    @cached_property
    def velocity(self) -> Array:
        """Velocity of the base into the solid [m/s], of shape (n,), the mean of each pass."""
        velocity = np.zeros_like(self.base)
        for rows in (~self.moves_out & ~self.rests, self.moves_out):
            if rows.any() and np.ptp(self.clock[rows]) > 0:
                velocity[rows] = np.polyfit(self.clock[rows], self.base[rows], 1)[0]
        return velocity

    def at_velocity(self, velocity: float) -> Curve:
        """Return the same rows with one velocity of the base [m/s]."""
        curve = replace(self)
        curve.__dict__["velocity"] = np.full_like(self.position, velocity)
        return curve

    @cached_property
    def sine_stiffness(self) -> NDArray[np.complex128]:
        """K′ + iK″ of the sines [N/m], of shape (m,)."""
        return np.array([sine.stiffness for sine in self.sines], dtype=complex)

    @cached_property
    def held(self) -> Curve:
        """The states about which sines oscillate, a row each."""
        position, force, time = np.array([(s.position, s.force, s.time) for s in self.sines]).T
        still = np.zeros(force.size, dtype=bool)
        at_rest = replace(
            self, position=position, force=force, time=time, unloading=still, counts=None, sines=()
        )
        return at_rest.at_velocity(0.0)

    @cached_property
    def smooth_force(self) -> Array:
        """Means of the forces of neighbours on one pass [N]."""
        smoothed = np.empty_like(self.force)
        for rows in self.passes:
            sums = np.concatenate([[0.0], np.cumsum(self.force[rows])])
            row = np.arange(rows.size)
            # As many on both sides, so that a slope stays.
            wide = np.minimum(_NEIGHBOURS, np.minimum(row, rows.size - 1 - row))
            smoothed[rows] = (sums[row + wide + 1] - sums[row - wide]) / (2 * wide + 1)
        return smoothed

    @cached_property
    def contact(self) -> Contact:
        """The contact with a half-space of modulus 1 Pa.

        It is tabulated down to a depth that no trial of a contact point exceeds.
        """
        deepest = (1 + BEFORE) * max(float(np.ptp(self.base)), self.span)
        if self.touch is not None:
            # A given point may lie before any row.
            bent = self.largest / (self.stiffness or np.inf)
            deepest = max(deepest, float(np.max(self.position)) - self.touch + bent)
        return Contact.on_half_space(self.indenter, 1.0, deepest)

    @cached_property
    def coarse(self) -> Curve:
        """Few means, which tell where a minimum is."""
        return replace(self.bin_means(_COARSE), is_rough=True)

    @cached_property
    def span(self) -> float:
        """Range of the positions [m]."""
        return float(np.ptp(self.position))

    @cached_property
    def largest(self) -> float:
        """Range of the forces [N]."""
        return float(np.ptp(self.force))

    @cached_property
    def weights(self) -> Array:
        """Square root of the rows that each row stands for, by which residuals are multiplied."""
        return np.ones_like(self.force) if self.counts is None else np.sqrt(self.counts)

    def _groups(self, bins: int) -> list[NDArray[np.intp]]:
        """Return groups of neighbouring rows of each pass, at most ``bins`` for each.

        They are even in rows and, where force and position say that it touches, in the position: a
        long path may touch in its last hundredth.  In a hold they are even in the logarithm of the
        time, too, as solids relax.
        """
        groups = []
        for rows in self.passes:
            if rows.size <= bins:
                groups += [*rows[:, None]]
                continue
            inward = rows[::-1] if self.moves_out[rows[0]] else rows
            force, way = self.smooth_force[inward], np.maximum.accumulate(self.position[inward])
            clear = way[np.argmax(force > force.min() + _CLEAR * float(np.ptp(force)))]
            near = np.maximum(way - way[-1] + _WAYS * (way[-1] - clear), 0.0)
            along, parts = np.arange(rows.size) / rows.size + near / (near[-1] or 1.0), 2
            if self.time is not None and self.rests[inward].any():
                resting = np.cumsum(self.rests[inward])
                along, parts = along + np.log1p(resting) / np.log1p(resting[-1]), 3
            ends = np.unique(np.searchsorted(along, np.arange(1, bins) * (parts / bins)))
            groups += sorted(
                (np.sort(part) for part in np.split(inward, ends) if part.size), key=min
            )
        return groups

    def bin_means(self, bins: int) -> Curve:
        """Return means of neighbouring rows, at most ``bins`` for each pass.

        Over so short a way a force without jumps is straight: but for a constant, χ² of the rows is
        that of the means, weighted by their number.
        """
        groups = self._groups(bins)
        if len(groups) == self.force.size:
            return self
        order, counts = np.concatenate(groups), np.array([group.size for group in groups])
        starts = np.cumsum(counts) - counts

        def mean(values: Array) -> Array:
            return np.asarray(np.add.reduceat(values[order], starts) / counts)

        return replace(
            self,
            position=mean(self.position),
            force=mean(self.force),
            time=None if self.time is None else mean(self.time),
            unloading=self.moves_out[order[starts]],
            counts=counts.astype(float),
        )
