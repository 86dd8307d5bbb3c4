"""Which curves of a population are alike, so that what one rules out need not be compared again."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.errors import PellicleError

from .config import FitConfig
from .config_input import describe_indenter
from .estimation.noise import neighbour_noise
from .files.sources import Source
from .population.row import Row
from .selection.neighbour import Neighbour

_EVERY = 16
"""One in how many curves that are alike has all explanations compared."""
_FEW = 8
"""Number of curves that are alike from which on others are spared."""
_CLASS = 0.25
"""Width of a class of numbers that are alike, in their logarithms."""
_LEAST = 0.5
"""Least information of a curve over that of another whose exclusions hold for it."""

_RISE = 0.05, 0.9
"""Shares of the range of the force between which a curve has its shape."""


class Near(NamedTuple):
    """A curve beside another."""

    row: int
    rules_out: bool
    """Whether what it rules out is ruled out there as well."""


def representatives(
    config: FitConfig, sources: Sequence[Source], rows: Sequence[Row]
) -> list[tuple[Near, ...]]:
    """Return for each curve those that speak for it, the nearest first; none for these."""
    kinds: list[Hashable] = []
    known, rises = np.zeros(len(rows)), [(np.zeros(0), np.zeros(0))] * len(rows)
    for i, (source, row) in enumerate(zip(sources, rows, strict=True)):
        curve = source.curve
        if isinstance(curve, PellicleError) or row.failure:
            kinds.append(row)
            continue
        known[i], rises[i] = _information(curve.force), (curve.position, curve.force)
        of_instrument = curve.stiffness, curve.speed, curve.time is None, curve.is_depth
        kinds.append(
            kind_of(row.group, describe_indenter(config.indenter_of(source)), *of_instrument)
        )
    return [
        tuple(Near(j, bool(own >= _LEAST * known[j])) for j in near)
        for own, near in zip(known, neighbours(kinds, order_of(rises)), strict=True)
    ]


def beside(rows: Sequence[Row], near: Sequence[Near]) -> list[Neighbour]:
    """Return what curves say that were fitted and of which all explanations were compared."""
    found = []
    for other in near:
        row = rows[other.row]
        if row.is_fitted and not row.fit.data.get("not_weighed"):
            one = Neighbour.of_dict(row.fit.data)
            found.append(one if other.rules_out else one._replace(ruled_out=frozenset()))
    return found


def kind_of(*properties: object) -> Hashable:
    """Return a key that curves have in common whose numbers differ little, and all else not."""

    def key(value: object) -> Hashable:
        if isinstance(value, Mapping):
            return tuple(sorted((str(name), key(entry)) for name, entry in value.items()))
        if isinstance(value, float) and value:
            return round(float(np.log(abs(value))) / _CLASS)
        return str(value)

    return tuple(map(key, properties))


def neighbours(kinds: Sequence[Hashable], order: ArrayLike = 0.0) -> list[list[int]]:
    """Return for each curve those of its kind that speak for it, the nearest in order first.

    These are one in 16 in their order, and have none; nor have curves of which there are few.  So
    each material of a map has some, wherever its regions lie.
    """
    at = np.broadcast_to(np.asarray(order, dtype=float), len(kinds))
    found: list[list[int]] = [[] for _ in kinds]
    groups: dict[Hashable, list[int]] = defaultdict(list)
    for i, kind in enumerate(kinds):
        groups[kind].append(i)
    for members in groups.values():
        some = sorted(members, key=lambda i: float(at[i]))
        for number, i in enumerate(some if len(some) >= _FEW else ()):
            first = number - number % _EVERY
            if number > first:
                around = some[first], *some[first + _EVERY : first + _EVERY + 1]
                # What another material rules out may be what this one is.
                own = [j for j in around if int(at[j]) == int(at[i])] or around
                found[i] = sorted(own, key=lambda j: (abs(at[j] - at[i]), abs(j - i)))
    return found


def order_of(curves: Sequence[tuple[Array, Array]]) -> Array:
    """Return a number for each curve by its position and force, by which curves alike are together.

    Its whole part counts strata of stiffness with a gap below each, its fraction is the shape: the
    mean force over the way on which it rises, over the rise.  Both are those of materials, where
    contact points and places are not.
    """
    traits = np.array([_traits(*curve) for curve in curves]).reshape(-1, 2)
    stiffness, shape = traits.T
    order, strata = np.argsort(stiffness, kind="stable"), np.zeros(len(traits))
    strata[order[1:]] = np.cumsum(np.diff(stiffness[order]) > _CLASS)
    return np.asarray(strata + np.clip(shape, 0.0, 0.99))


def _traits(position: Array, force: Array) -> tuple[float, float]:
    """Return the logarithm of the stiffness of a curve, and its shape; 0 if it does not rise."""
    rows = np.isfinite(position) & np.isfinite(force)
    position, force = position[rows], force[rows]
    if not force.size:
        return 0.0, 0.0
    bottom, top = float(np.quantile(force, 0.1)), float(force.max())
    if not bottom < top:
        return 0.0, 0.0
    share = (force[: np.argmax(force) + 1] - bottom) / (top - bottom)
    first = int(np.flatnonzero(share <= _RISE[0])[-1:].sum())
    last = first + int(np.argmax(share[first:] >= _RISE[1]))
    way = abs(float(position[last] - position[first]))
    if not way:
        return 0.0, 0.0
    shape = np.trapezoid(share[first : last + 1], position[first : last + 1]) / way
    return float(np.log((top - bottom) / way)), abs(float(shape))


def _information(force: Array) -> float:
    """Return Σ (F/noise)² of the rows of a curve if all had the largest force F [N]."""
    noise = max(neighbour_noise(force).deviation, 1e-300)
    return float(force.size * (np.ptp(force) / noise) ** 2)
