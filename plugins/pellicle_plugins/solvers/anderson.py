"""Extrapolation of rounds that are linear (Anderson 1965)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pellicle.arrays import Array, Mask


class RoundRecord(NamedTuple):
    """Input and outcome of a round, each of the shape of the grid."""

    traction: Array
    """Traction across the gap [Pa]."""
    missed: Array
    """Traction of the law less that [Pa]."""
    wall: Array
    """Wall pressure [Pa]."""


def extrapolate_rounds(rounds: Sequence[RoundRecord], contact: Mask) -> RoundRecord:
    """Return the combination of rounds on one contact that misses least off it.

    Its coefficients sum to 1.  It is the last round itself if the step from there goes against the
    missed tractions, the direction of falling energy: to a saddle.
    """
    latest = rounds[-1]
    if len(rounds) == 1:
        return latest
    cells = np.flatnonzero(np.any([one.missed != 0 for one in rounds], axis=0) & ~contact)
    missed = np.array([one.missed.ravel()[cells] for one in rounds])
    weights, *_ = np.linalg.lstsq(np.diff(missed, axis=0).T, missed[-1], rcond=1e-10)
    found = RoundRecord(*(part.copy() for part in latest))
    for weight, one, other in zip(weights, rounds, rounds[1:], strict=False):
        for part, before, after in zip(found, one, other, strict=True):
            part -= weight * (after - before)
    step = found.traction + found.missed - latest.traction
    falls = float((step * latest.missed).ravel()[cells].sum()) > 0
    return found if falls else latest


def is_convex(before: RoundRecord, after: RoundRecord, contact: Mask) -> bool:
    """Return whether the energy is convex between two rounds, so that a minimum may be sought.

    Where it is not, the state between two positions of the edge on the lattice is unstable, and an
    extrapolation would return to it.
    """
    step, change = after.traction - before.traction, after.missed - before.missed
    return float((step * change)[~contact].sum()) < 0
