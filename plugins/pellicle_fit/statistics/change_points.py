"""Change points of curves with adhesion: the rows at which the contact begins and ends."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import PellicleError
from pellicle_fit.models.adhesive import WORK_OF_ADHESION, AdhesiveModel
from pellicle_fit.models.force_model import ForceModel
from pellicle_fit.parameters import CONTACT_POINT

from .chi_squared import ChiSquared, Minimum
from .condensed import Rows
from .likelihood import Likelihood

if TYPE_CHECKING:
    from .rival import Rival

_CHANGE_POINT = 2
"""Parameters for which a searched number of rows in contact counts.  Beside a tension the search
gained 3.8 in χ² by chance, over 28 curves of both passes; without this price it hid tensions.  For
AIC a change point counts as three (Ninomiya 2015), since it also costs at the next curve."""
_LOST = 12.0
"""Δχ² beyond which no more, or fewer, rows are taken to touch."""
_SINGLE = 8
"""Numbers of rows that are tried one by one, before steps grow by this share."""
_VANISHED = 5.0
"""Fall of the logarithm of a work of adhesion beyond which a search has lost it."""
_VISIBLE = 0.5
"""Jump of the force at first touch, over the noise, below which χ² hardly jumps."""
_EQUAL = 1e-9
"""Distance of rows, over the range of positions, up to which they touch together."""


def with_change_points(
    rival: Rival, chi_squared: ChiSquared, best: Minimum, work: float
) -> tuple[Rival, Minimum]:
    """Return an explanation by adhesion whose model has fixed rows that touch, and its minimum.

    They are those of least χ².  Neighbours of them are kept as `Rival.others`.  ``best`` is the
    minimum where the model decides which rows touch, ``work`` the logarithm of a work of adhesion
    from which searches start again that lose it.
    """
    rival, best = _with_last_touch(rival, chi_squared, best, work)
    for index in range(len(chi_squared.members)):
        rival, best = _with_first_touch(rival, chi_squared, best, index)
    return rival, best


def _with_last_touch(
    rival: Rival, chi_squared: ChiSquared, best: Minimum, work: float
) -> tuple[Rival, Minimum]:
    """Return the minimum with fixed rows of a retraction that touch, and the model of these.

    As the end of the branch passes a row χ² jumps, and searches and profiles stop there.
    Searches that lose the adhesion start again from a logarithm of the work of adhesion.
    """
    touching = _touching(rival, chi_squared, best)
    if touching is None:
        return rival, best

    def trial(shift: int, near: Minimum) -> tuple[Rival, Minimum] | None:
        pair = _with_rows(rival, chi_squared, near, touching, shift)
        if pair is None or pair[1].parameters[WORK_OF_ADHESION] > work - _VANISHED:
            return pair
        # χ² does not depend on a work of adhesion this small, so no search leaves it.
        adhering = near._replace(parameters=near.parameters | {WORK_OF_ADHESION: work})
        again = _with_rows(rival, chi_squared, adhering, touching, shift)
        return pair if again is None else min(pair, again, key=lambda p: p[1].chi_squared)

    pairs = _around(trial, chi_squared, best)
    if not pairs:
        return rival, best
    (least_rival, minimum), *others = pairs
    searched = _CHANGE_POINT if others else 0
    return replace(least_rival, others=tuple(others), searched=searched), minimum


def _touching(rival: Rival, chi_squared: ChiSquared, at: Minimum) -> tuple[int, ...] | None:
    """Return how many of the undecided rows of each curve touch; None if jumps decide all."""
    counts, is_undecided = [], False
    for member, part in rival.of(chi_squared).curves(at.parameters):
        model = member.force_model
        assert isinstance(model, AdhesiveModel)
        depth = member.base[_undecided(model, member)] - part[CONTACT_POINT]
        values = {p: p.value(part[p]) for p in model.parameters}
        end = model.end(values, float(depth.max(initial=0.0)))
        counts.append(int(np.sum(depth >= end)))
        is_undecided = is_undecided or bool(depth.size)
    return tuple(counts) if is_undecided else None


def _with_rows(
    rival: Rival,
    chi_squared: ChiSquared,
    near: Minimum,
    touching: tuple[int, ...],
    more: int,
) -> tuple[Rival, Minimum] | None:
    """Return the model in which the deepest undecided rows touch, and its minimum.

    They are ``more`` than ``touching`` in each curve.  None is returned if a curve has not as
    many, or if the search does not converge.
    """
    models: list[tuple[Array, ForceModel]] = []
    for (member, _), count in zip(
        rival.of(chi_squared).curves(near.parameters), touching, strict=True
    ):
        model = member.force_model
        assert isinstance(model, AdhesiveModel)
        rows = _undecided(model, member)
        if rows.size and not 0 <= count + more <= rows.size:
            return None
        attached, ended = model.attached.copy(), np.full(member.force.size, False)
        first = rows.size - count - more if rows.size else 0
        attached[rows] = np.where(np.arange(rows.size) < first, -1.0, 1.0)
        ended[rows[:first]] = True
        models.append((member.position, replace(model, attached=attached, ended=ended)))

    return _near(rival, chi_squared, near, models)


def _with_first_touch(
    rival: Rival, chi_squared: ChiSquared, best: Minimum, index: int
) -> tuple[Rival, Minimum]:
    """Return the minimum with fixed rows of an approach that touch, and the model of these.

    As the contact point passes a row χ² jumps, and searches and profiles stop there: seven to
    ten rows off, with works of adhesion a fifth too large.
    """
    members = rival.of(chi_squared).curves(best.parameters)
    member, part = members[index]
    model = member.force_model
    assert isinstance(model, AdhesiveModel)
    rows = np.flatnonzero(~member.moves_out & (model.attached == 0))
    if CONTACT_POINT not in member.free or not rows.size:
        return rival, best
    values = {p: p.value(part[p]) for p in model.parameters}
    deepest = float(member.base.max()) - part[CONTACT_POINT]
    if abs(model.jump(values, deepest)) < _VISIBLE * member.noise:
        return rival, best
    base = member.base[rows]
    edges = np.unique(base)
    apart = np.diff(edges) > _EQUAL * np.ptp(base)
    farthest = edges[0] - np.ptp(base)
    edges = np.concatenate([[farthest], edges[:1], edges[1:][apart]])

    def gap_of(point: float) -> int:
        return max(int(np.searchsorted(edges, point)) - 1, 0)

    first = gap_of(part[CONTACT_POINT])

    def touching(shift: int, near: Minimum) -> tuple[Rival, Minimum] | None:
        place = first + shift
        if not 0 <= place < edges.size - 1:
            return None
        low, high = edges[place : place + 2].tolist()
        attached = model.attached.copy()
        attached[rows] = np.where(base >= high, 1.0, -1.0)
        known = replace(model, attached=attached, touches_between=(low, high))
        models = [(other.position, other.force_model) for other, _ in members]
        models[index] = member.position, known
        return _near(rival, chi_squared, near, models)

    pairs = _around(touching, chi_squared, best)
    if not pairs:
        return rival, best
    (least_rival, minimum), *others = pairs
    last = gap_of(minimum.parameters[CONTACT_POINT.of_curve(index)])
    if abs(last - first) > _SINGLE and minimum.chi_squared < best.chi_squared:
        # Rows near it have been left out.
        return _with_first_touch(rival, chi_squared, minimum, index)
    return replace(least_rival, others=(*rival.others, *others)), minimum


def _near(
    rival: Rival,
    chi_squared: ChiSquared,
    start: Minimum,
    models: Sequence[tuple[Array, ForceModel]],
) -> tuple[Rival, Minimum] | None:
    """Return the same with known models, and its minimum near a start; None if that fails.

    The models are those of curves that their positions identify.
    """

    def build(likelihood: Likelihood) -> ForceModel:
        known = (model for position, model in models if likelihood.position is position)
        return next(known, None) or rival.build(likelihood)

    known_rival = replace(rival, build=build)
    with suppress(PellicleError):
        minimum = known_rival.of(chi_squared).minimise(start.parameters, rough=True)
        return known_rival, minimum
    return None


def _around(
    trial: Callable[[int, Minimum], tuple[Rival, Minimum] | None],
    chi_squared: ChiSquared,
    best: Minimum,
) -> list[tuple[Rival, Minimum]]:
    """Return models with 0, 1, … and −1, −2, … rows more, and their minima, the least first.

    Either way ends where χ² is far above the least, or where ``trial`` has no model; that gets the
    minimum before as a start.
    """
    rise = _LOST / sum(member.force.size for member in chi_squared.members)
    pairs: list[tuple[Rival, Minimum]] = []
    for sense in (1, -1):
        shift, near = max(sense, 0) - 1, best
        while (pair := trial(shift, near)) is not None:
            pairs.append(pair)
            near = pair[1]
            lowest = min(minimum.chi_squared for _, minimum in pairs)
            if near.chi_squared > lowest * (1 + rise):
                break
            shift += sense * (1 + abs(shift) // _SINGLE)
    return sorted(pairs, key=lambda pair: pair[1].chi_squared)


def _undecided(model: AdhesiveModel, likelihood: Likelihood) -> Rows:
    """Return the rows of a retraction that no jump tells to touch or not, by increasing depth."""
    rows = np.flatnonzero(likelihood.moves_out & (model.attached == 0))
    return rows[np.argsort(likelihood.base[rows], kind="stable")]
