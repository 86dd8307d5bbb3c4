"""Where the least χ² of several curves is: together, each alone, and without tension."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pellicle.arrays import Array
from pellicle.fitting.explained import Explained

from .initial_guess import KEPT
from .likelihood import MODULUS, TENSION, Minimum, best_minimum, least
from .pooled_likelihood import SHARED, Pool


def begin(pool: Pool, every: Sequence[Explained]) -> Minimum:
    """Return the least χ² near what the curves that tell most say alone, or near their median."""
    told = sorted(every, key=_uncertainty)[:KEPT]
    median = np.median([each.parameters[SHARED] for each in every], axis=0)
    tries = [*(each.parameters[SHARED] for each in told), median]
    return least(_from(pool, [each.parameters for each in every], shared) for shared in tries)


def _uncertainty(each: Explained) -> float:
    return float(each.likelihood.deviations(each.parameters)[MODULUS])


def _from(pool: Pool, parts: Sequence[Array], shared: Array, held: Sequence[int] = ()) -> Minimum:
    """Return the least χ² near parameters of each curve, modulus and tension replaced."""
    begun = []
    for member, part in zip(pool.members, parts, strict=True):
        start = part.copy()
        start[SHARED] = shared
        begun.append(member.minimise(start, SHARED).parameters)
    return pool.minimise(pool.joined(begun), held)


def alone(each: Explained, part: Array) -> Minimum:
    """Return the least χ² of a curve by itself."""
    return best_minimum(each.likelihood, (each.parameters, part))


def without_tension(pool: Pool, best: Minimum) -> Minimum:
    """Return the least χ² without tension, near the pool's and near each curve's by itself."""
    held = (TENSION,)
    parts = pool.parts(best.parameters)
    for part in parts:
        part[TENSION] = 0.0
    own = [
        member.minimise(part, held).parameters
        for member, part in zip(pool.members, parts, strict=True)
    ]
    shared = np.median([each[SHARED] for each in own], axis=0)
    return least([pool.minimise(pool.joined(parts), held), _from(pool, own, shared, held)])
