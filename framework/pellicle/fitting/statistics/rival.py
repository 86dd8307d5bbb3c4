"""An explanation of a curve, and its minima of χ²."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import PellicleError
from pellicle.fitting.models.adhesive import WORK_OF_ADHESION, AdhesiveModel
from pellicle.fitting.models.force_model import ForceModel, TensionModel
from pellicle.fitting.models.layer import FreeLayerModel
from pellicle.fitting.models.relaxing import (
    RelaxingModel,
)
from pellicle.fitting.parameters import (
    CONTACT_POINT,
    TENSION,
    THICKNESS,
    Coordinates,
    Parameter,
)

from .chi_squared import ChiSquared, Minimum, least
from .condensed import Rows
from .initial_guess import initial_guesses
from .likelihood import Likelihood
from .profile import OPEN, Ends, extended, profiled

_CHANGE_POINT = 2
"""Parameters for which a searched number of rows in contact counts.  Beside a tension the search
gained 3.8 in χ² by chance, over 28 curves of both passes; without this price it hid tensions.  For
AIC a change point counts as three (Ninomiya 2015), since it also costs at the next curve."""
_THIN = 200
"""Rows of a curve that is scanned for initial guesses."""
_LONG = 3000
"""Rows of a curve beyond which searches are condensed; below, the rows cost little."""
_COARSE = 0.3
"""Error of the condensed χ² of a search, in its unit; the minimum is that of all rows."""
_THICKNESSES = (2.0, 10.0)
"""Thicknesses from which a search starts, over the range of positions."""
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
_SHARES = (0.0, 0.1)
"""Values of a parameter that is not logarithmic from which a search starts, over its scale."""


@dataclass(frozen=True)
class Rival:
    """An explanation of a curve: a force model, and the parameters that it fits."""

    code: str
    """Name in tables, such as ``tension+power_law``."""
    words: str
    """Name in sentences."""
    has_tension: bool
    build: Callable[[Likelihood], ForceModel]
    """Return the force model for the rows of a curve."""
    own: tuple[Parameter, ...] = ()
    """Parameters beside modulus, tension, contact point and baseline."""
    baseline: tuple[Parameter, ...] = ()
    """Parameters of the baseline that are fitted even if the fit itself does not."""

    of_shape: bool = False
    """Whether it is another shape, for which a tension can make up in any curve."""
    others: tuple[tuple[Rival, Minimum], ...] = ()
    """The same with more or fewer rows that touch, and their minima."""
    searched: int = 0
    """Number of parameters for which the rows in contact count that have been searched."""

    @property
    def is_single(self) -> bool:
        """Whether it is one effect alone."""
        return "+" not in self.code

    def of(self, chi_squared: ChiSquared) -> ChiSquared:
        """Return χ² with this model in place of an elastic solid under tension."""
        return chi_squared.with_members([self.of_curve(m) for m in chi_squared.members])

    def of_curve(self, likelihood: Likelihood) -> Likelihood:
        """Return the likelihood of a curve with this model."""
        free = [p for p in likelihood.free if p != TENSION or self.has_tension]
        free += [p for p in (*self.own, *self.baseline) if p not in free]
        return replace(likelihood, force_model=self.build(likelihood), free=tuple(free))

    def start(self, chi_squared: ChiSquared, known: Coordinates) -> Coordinates:
        """Return coordinates for all parameters of a χ² of this model."""
        defaults = {WORK_OF_ADHESION: -20.0, THICKNESS: -10.0}
        start = {p: known.get(p, defaults.get(p, 0.0)) for p in chi_squared.parameters}
        return start if self.has_tension or TENSION not in start else start | {TENSION: 0.0}

    def minimum(
        self, chi_squared: ChiSquared, starts: Sequence[Coordinates]
    ) -> tuple[Rival, Minimum] | None:
        """Return the least minimum of χ² near several starts, and the model that has it.

        That model may know more: which rows touch.  ``starts`` may lack the parameters of its own,
        of which it has guesses.  None is returned if no search converges.
        """
        own, minima, was_thin, works = self.of(chi_squared), [], False, []
        is_long = max(member.force.size for member in chi_squared.members) > _LONG
        for start in starts:
            whole = self.start(own, start)
            known = [p for p in self.own if p in start]
            guesses = [{}] if len(known) == len(self.own) else self._guesses(own, whole)
            for guess in guesses:
                works.append((whole | guess).get(WORK_OF_ADHESION, -np.inf))
                with suppress(PellicleError):
                    thin = own.condensed(whole | guess, _COARSE) if is_long else own
                    was_thin = was_thin or thin is not own
                    minima.append(thin.minimise(whole | guess, rough=True))
        if not minima:
            return None
        best = least(minima)
        if WORK_OF_ADHESION in self.own:
            rival, best = self._attached(chi_squared, best, max(works))
            for index in range(len(chi_squared.members)):
                rival, best = rival._first_touch(chi_squared, best, index)
            return rival, best
        return self, own.minimise(best.parameters, rough=True) if was_thin else best

    def intervals(
        self,
        chi_squared: ChiSquared,
        minimum: Minimum,
        threshold: float,
        parameters: Sequence[Parameter],
    ) -> tuple[Minimum, dict[Parameter, Ends]]:
        """Return the minimum, which a profile may have improved, and intervals of profiles.

        Where the model decides which rows touch, an interval is the union of those of all numbers
        of rows whose χ² is within ``threshold`` of the least.
        """
        minimum, ends = profiled(self.of(chi_squared), minimum, threshold, parameters)
        highest = minimum.chi_squared + threshold
        for other, near in self._others_below(chi_squared, highest):
            ends = {p: extended(other, near, p, ends.get(p, OPEN), highest) for p in parameters}
        return minimum, ends

    def extended(
        self,
        chi_squared: ChiSquared,
        minimum: Minimum,
        threshold: float,
        parameter: Parameter,
        ends: Ends,
    ) -> Ends:
        """Return an interval, extended to that which `intervals` finds for a parameter.

        That costs two searches where it reaches no further.
        """
        highest = minimum.chi_squared + threshold
        nearby = (self.of(chi_squared), minimum), *self._others_below(chi_squared, highest)
        for of_rival, near in nearby:
            ends = extended(of_rival, near, parameter, ends, highest)
        return ends

    def _others_below(
        self, chi_squared: ChiSquared, highest: float
    ) -> Iterator[tuple[ChiSquared, Minimum]]:
        """Yield χ² with other rows that touch, and its minimum, where that is below ``highest``."""
        for rival, start in self.others:
            other = rival.of(chi_squared)
            near = other.minimise(start.parameters, rough=True)
            if near.chi_squared < highest:
                yield other, near

    def _attached(
        self, chi_squared: ChiSquared, best: Minimum, work: float
    ) -> tuple[Rival, Minimum]:
        """Return the minimum with fixed rows of a retraction that touch, and the model of these.

        As the end of the branch passes a row χ² jumps, and searches and profiles stop there.
        Searches that lose the adhesion start again from a logarithm of the work of adhesion.
        """
        touching = self._touching(chi_squared, best)
        if touching is None:
            return self, best

        def trial(shift: int, near: Minimum) -> tuple[Rival, Minimum] | None:
            pair = self._with_rows(chi_squared, near, touching, shift)
            if pair is None or pair[1].parameters[WORK_OF_ADHESION] > work - _VANISHED:
                return pair
            # χ² does not depend on a work of adhesion this small, so no search leaves it.
            adhering = near._replace(parameters=near.parameters | {WORK_OF_ADHESION: work})
            again = self._with_rows(chi_squared, adhering, touching, shift)
            return pair if again is None else min(pair, again, key=lambda p: p[1].chi_squared)

        pairs = _around(trial, chi_squared, best)
        if not pairs:
            return self, best
        (rival, minimum), *others = pairs
        searched = _CHANGE_POINT if others else 0
        return replace(rival, others=tuple(others), searched=searched), minimum

    def _touching(self, chi_squared: ChiSquared, at: Minimum) -> tuple[int, ...] | None:
        """Return how many of the undecided rows of each curve touch; None if jumps decide all."""
        counts, is_undecided = [], False
        for member, part in self.of(chi_squared).curves(at.parameters):
            model = member.force_model
            assert isinstance(model, AdhesiveModel)
            depth = member.base[_undecided(model, member)] - part[CONTACT_POINT]
            values = {p: p.value(part[p]) for p in model.parameters}
            end = model.end(values, float(depth.max(initial=0.0)))
            counts.append(int(np.sum(depth >= end)))
            is_undecided = is_undecided or bool(depth.size)
        return tuple(counts) if is_undecided else None

    def _with_rows(
        self, chi_squared: ChiSquared, near: Minimum, touching: tuple[int, ...], more: int
    ) -> tuple[Rival, Minimum] | None:
        """Return the model in which the deepest undecided rows touch, and its minimum.

        They are ``more`` than ``touching`` in each curve.  None is returned if a curve has not as
        many, or if the search does not converge.
        """
        models: list[tuple[Array, ForceModel]] = []
        for (member, _), count in zip(
            self.of(chi_squared).curves(near.parameters), touching, strict=True
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

        return self._near(chi_squared, near, models)

    def _first_touch(
        self, chi_squared: ChiSquared, best: Minimum, index: int
    ) -> tuple[Rival, Minimum]:
        """Return the minimum with fixed rows of an approach that touch, and the model of these.

        As the contact point passes a row χ² jumps, and searches and profiles stop there: seven to
        ten rows off, with works of adhesion a fifth too large.
        """
        members = self.of(chi_squared).curves(best.parameters)
        member, part = members[index]
        model = member.force_model
        assert isinstance(model, AdhesiveModel)
        rows = np.flatnonzero(~member.moves_out & (model.attached == 0))
        if CONTACT_POINT not in member.free or not rows.size:
            return self, best
        values = {p: p.value(part[p]) for p in model.parameters}
        deepest = float(member.base.max()) - part[CONTACT_POINT]
        if abs(model.jump(values, deepest)) < _VISIBLE * member.noise:
            return self, best
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
            return self._near(chi_squared, near, models)

        pairs = _around(touching, chi_squared, best)
        if not pairs:
            return self, best
        (rival, minimum), *others = pairs
        last = gap_of(minimum.parameters[CONTACT_POINT.of_curve(index)])
        if abs(last - first) > _SINGLE and minimum.chi_squared < best.chi_squared:
            # Rows near it have been left out.
            return self._first_touch(chi_squared, minimum, index)
        return replace(rival, others=(*self.others, *others)), minimum

    def _near(
        self,
        chi_squared: ChiSquared,
        start: Minimum,
        models: Sequence[tuple[Array, ForceModel]],
    ) -> tuple[Rival, Minimum] | None:
        """Return the same with known models, and its minimum near a start; None if that fails.

        The models are those of curves that their positions identify.
        """

        def build(likelihood: Likelihood) -> ForceModel:
            known = (model for position, model in models if likelihood.position is position)
            return next(known, None) or self.build(likelihood)

        rival = replace(self, build=build)
        with suppress(PellicleError):
            return rival, rival.of(chi_squared).minimise(start.parameters, rough=True)
        return None

    def _guesses(self, chi_squared: ChiSquared, start: Coordinates) -> list[Coordinates]:
        members = chi_squared.curves(start)
        model = members[0][0].force_model
        if isinstance(model, RelaxingModel):
            own = [g for m, _ in (members[0], members[-1]) for g in _own_guesses(m.force_model)]
            return [
                {p: p.coordinate(v) for p, v in guess.items()}
                for number, guess in enumerate(own)
                if guess not in own[:number]
            ]
        if isinstance(model, FreeLayerModel):
            span = chi_squared.ranges[CONTACT_POINT].scale
            return [{THICKNESS: float(np.log(share * span))} for share in _THICKNESSES]
        if isinstance(model, AdhesiveModel):
            return list(_adhesive_guesses(self, chi_squared, start))
        scales = chi_squared.ranges
        return [{p: share * scales[p].scale for p in self.own} for share in _SHARES]


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


def _own_guesses(model: ForceModel) -> list[dict[Parameter, float]]:
    return model.own_guesses() if isinstance(model, RelaxingModel) else []


def _adhesive_guesses(
    rival: Rival, chi_squared: ChiSquared, start: Coordinates
) -> Iterator[Coordinates]:
    """Yield the best of a scan for each curve, the shared parameters from the first."""
    parts = []
    for member, part in chi_squared.curves(start):
        thin = rival.of_curve(replace(member.thinned(_THIN), force_model=elastic_of(member)))
        span = max(member.deepest(part), 0.05 * float(np.ptp(member.position)))
        points = part[CONTACT_POINT] + span * np.linspace(-0.3, 0.6, 13)
        model = thin.force_model
        assert isinstance(model, AdhesiveModel)
        # One branch for all contact points: the branch is most of the cost of the force.
        model = replace(model, reach=float(thin.base.max() - points[0]))
        thin = replace(thin, force_model=model)
        points = points[points < member.position.max()]
        best = initial_guesses(thin, part, points.tolist())
        if not best:
            return
        parts.append(best)
    for rank in range(min(map(len, parts))):
        yield chi_squared.joined([best[rank] for best in parts])


def _undecided(model: AdhesiveModel, likelihood: Likelihood) -> Rows:
    """Return the rows of a retraction that no jump tells to touch or not, by increasing depth."""
    rows = np.flatnonzero(likelihood.moves_out & (model.attached == 0))
    return rows[np.argsort(likelihood.base[rows], kind="stable")]


def elastic_of(likelihood: Likelihood) -> TensionModel:
    """Return the elastic solid under tension in a force model."""
    model = likelihood.force_model
    elastic = getattr(model, "elastic", model)
    assert isinstance(elastic, TensionModel)
    return elastic
