"""An explanation of a curve, and its minima of χ²."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from pellicle.errors import PellicleError
from pellicle_fit.models.adhesive import WORK_OF_ADHESION, AdhesiveModel
from pellicle_fit.models.force_model import ForceModel, TensionModel
from pellicle_fit.models.layer import FreeLayerModel
from pellicle_fit.models.relaxing import EXPONENT, SHARE, RelaxingModel
from pellicle_fit.parameters import CONTACT_POINT, TENSION, THICKNESS, Coordinates, Parameter

from .change_points import with_change_points
from .chi_squared import ChiSquared, Minimum, least
from .initial_guess import initial_guesses
from .likelihood import Likelihood
from .profile import OPEN, Ends, extended, profiled

_THIN = 200
"""Rows of a curve that is scanned for initial guesses."""
_LONG = 3000
"""Rows of a curve beyond which searches are condensed; below, the rows cost little."""
_COARSE = 0.3
"""Error of the condensed χ² of a search, in its unit; the minimum is that of all rows."""
_THICKNESSES = (2.0, 10.0)
"""Thicknesses from which a search starts, over the range of positions."""
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
    has_size: bool = True
    """Whether the size of a shape is known; otherwise it determines no modulus."""
    others: tuple[tuple[Rival, Minimum], ...] = ()
    """The same with more or fewer rows that touch, and their minima."""
    searched: int = 0
    """Number of parameters for which the rows in contact count that have been searched."""

    @property
    def relaxes(self) -> bool:
        """Whether the solid relaxes."""
        return not {EXPONENT, SHARE}.isdisjoint(self.own)

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
        likelihood = replace(likelihood, free=tuple(free))
        return replace(likelihood, force_model=self.build(likelihood))

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
        own, minima, was_thin = self.of(chi_squared), [], False
        is_long = max(member.force.size for member in chi_squared.members) > _LONG
        guesses = [guess for start in starts for guess in self._starts(own, start)]
        for guess in guesses:
            with suppress(PellicleError):
                thin = own.condensed(guess, _COARSE) if is_long else own
                was_thin = was_thin or thin is not own
                minima.append(thin.minimise(guess, rough=True))
        if not minima:
            return None
        best = least(minima)
        if WORK_OF_ADHESION in self.own:
            work = max(guess[WORK_OF_ADHESION] for guess in guesses)
            return with_change_points(self, chi_squared, best, work)
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
        for other, near, rise in self._others_below(chi_squared, minimum, threshold):
            ends = {p: extended(other, near, rise, p, ends.get(p, OPEN)) for p in parameters}
        return minimum, ends

    def extended(
        self,
        chi_squared: ChiSquared,
        minimum: Minimum,
        threshold: float,
        ends: Mapping[Parameter, Ends],
    ) -> dict[Parameter, Ends]:
        """Return intervals, extended to those which `intervals` finds.

        Each costs two searches where it reaches no further.
        """
        own = self.of(chi_squared), minimum, threshold
        wider = dict(ends)
        for of_rival, near, rise in (own, *self._others_below(chi_squared, minimum, threshold)):
            for parameter, known in wider.items():
                wider[parameter] = extended(of_rival, near, rise, parameter, known)
        return wider

    def _others_below(
        self, chi_squared: ChiSquared, minimum: Minimum, threshold: float
    ) -> Iterator[tuple[ChiSquared, Minimum, float]]:
        """Yield χ² with other rows that touch, its minimum, and how far below the end that is.

        The end lies by ``threshold`` above ``minimum``; minima above it are left out.
        """
        for rival, start in self.others:
            other = rival.of(chi_squared)
            near = other.minimise(start.parameters, rough=True)
            rise = minimum.chi_squared + threshold - near.chi_squared
            if rise > 0:
                yield other, near, rise

    def _starts(self, own: ChiSquared, start: Coordinates) -> list[Coordinates]:
        """Return a start for all parameters, or several if it lacks those of this explanation."""
        whole = self.start(own, start)
        if all(p in start for p in self.own):
            return [whole]
        return [whole | guess for guess in self._guesses(own, whole)]

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


def elastic_of(likelihood: Likelihood) -> TensionModel:
    """Return the elastic solid under tension in a force model."""
    model = likelihood.force_model
    elastic = getattr(model, "elastic", model)
    assert isinstance(elastic, TensionModel)
    return elastic
