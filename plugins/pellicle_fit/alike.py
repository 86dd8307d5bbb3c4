"""Which curves of a population are alike, so that what one rules out need not be compared again."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import PellicleError

from .config import FitConfig
from .config_input import described
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


class Near(NamedTuple):
    """A curve beside another."""

    row: int
    rules_out: bool
    """Whether what it rules out is ruled out there as well."""


def alike(
    config: FitConfig, sources: Sequence[Source], rows: Sequence[Row]
) -> list[tuple[Near, ...]]:
    """Return for each curve those that speak for it, the nearest first; none for these."""
    kinds: list[Hashable] = []
    known = np.zeros(len(rows))
    for i, (source, row) in enumerate(zip(sources, rows, strict=True)):
        curve = source.curve
        if isinstance(curve, PellicleError) or row.failure:
            kinds.append(row)
            continue
        known[i] = _information(curve.force)
        of_instrument = curve.stiffness, curve.speed, curve.time is None, curve.is_depth
        kinds.append(kind_of(row.group, described(config.indenter_of(source)), *of_instrument))
    return [
        tuple(Near(j, bool(own >= _LEAST * known[j])) for j in near)
        for own, near in zip(known, neighbours(kinds), strict=True)
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


def neighbours(kinds: Sequence[Hashable]) -> list[list[int]]:
    """Return for each curve the nearest of its kind that speak for it, before and after it.

    These are one in 16, and have none; nor have curves of which there are few.
    """
    found: list[list[int]] = [[] for _ in kinds]
    groups: dict[Hashable, list[int]] = defaultdict(list)
    for i, kind in enumerate(kinds):
        groups[kind].append(i)
    for some in groups.values():
        for number, i in enumerate(some if len(some) >= _FEW else ()):
            first = number - number % _EVERY
            if number > first:
                around = some[first], *some[first + _EVERY : first + _EVERY + 1]
                found[i] = sorted(around, key=lambda j: abs(j - i))
    return found


def _information(force: Array) -> float:
    """Return Σ (F/noise)² of the rows of a curve if all had the largest force F [N]."""
    noise = max(neighbour_noise(force).deviation, 1e-300)
    return float(force.size * (np.ptp(force) / noise) ** 2)
