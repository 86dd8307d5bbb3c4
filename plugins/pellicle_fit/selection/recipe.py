"""Modulus, tension and contact point of curves, with intervals and a verdict."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc

from pellicle.errors import ConfigError
from pellicle_fit.contact.curve import Curve
from pellicle_fit.effect import Effect, Records, Responds, Solid
from pellicle_fit.estimation.candidate import NONE, Candidate, Types, best_of
from pellicle_fit.estimation.coordinates import CONTACT_POINT, MODULUS
from pellicle_fit.estimation.intervals import End, Estimate, common_value, estimates, threshold_of
from pellicle_fit.estimation.noise import CHANCE, ResidualCheck
from pellicle_fit.strangers import name_strangers, refuse_broken

from .baseline import baseline_of, rivals_of
from .neighbour import Neighbour
from .rivals import Question, at_common_noise, comparison
from .verdict import MANY_MARGIN, MARGIN, SMALL, Decision, Verdict, choice, decision, doubtful, ties

TENSION, DRAINING = "tension", "poroelastic"


@dataclass(frozen=True, eq=False)
class Answer:
    """What curves say about a solid, and about rivals of the model."""

    explanations: tuple[Candidate, ...]
    """Best first; estimates of those in `tied`."""
    question: Question
    decision: Decision
    selected: Candidate
    """The explanation whose estimates count."""
    tied: tuple[Candidate, ...]
    """What the curves cannot tell from it, itself included."""
    excused: Mapping[Types, str]
    """Why explanations could not be compared."""
    judgements: tuple[ResidualCheck, ...]
    """Noise and flaws of each curve under the best explanation."""
    threshold: float
    """Δχ² at the ends of intervals, which a disagreement of curves widens."""
    agreement: Agreement
    """Whether several curves agree on what they share."""
    untried: tuple[Types, ...]
    """Responses that act alone and whose force beside what is asked is not known."""
    not_weighed: tuple[Types, ...] = ()
    """Explanations that curves alike rule out."""
    baseline: tuple[Effect, ...] = ()
    """Rivals of the instrument that the curves need, so that all explanations have them."""
    elsewhere: Candidate | None = None
    """With another contact point than a given one, what describes the curve where that does not."""

    @property
    def verdict(self) -> Verdict:
        """Whether what is asked for is needed."""
        return self.decision.verdict

    @property
    def tension_needed(self) -> bool:
        """Whether the curves need a tension."""
        return self.question.of_target == {TENSION} and self.verdict is Verdict.NEEDED

    @property
    def at_this_speed(self) -> bool:
        """Whether the modulus is that at the speed of the curves: the solid may drain unseen.

        A round contact at one speed drains by the same part at each size, and looks elastic; two
        radii or speeds also do if it has drained by then, or not yet.
        """
        fit = self.selected
        if fit.known[0].of(Responds) or any(curve.rests.any() for curve in fit.all_rows):
            return False
        return any(DRAINING in other.types for other in self.explanations)

    @property
    def not_held(self) -> tuple[Candidate, ...]:
        """Tied explanations of so small a modulus that the curves do not hold it."""
        moduli = {fit: e.value for fit in self.tied if (e := fit.estimates.get(MODULUS))}
        # Only the least may be so beside all others.
        limit = SMALL * max(sorted(moduli.values())[1:2], default=0.0)
        return tuple(fit for fit, e in moduli.items() if fit is not self.selected and e < limit)

    @property
    def target(self) -> Candidate:
        """The best explanation with what is asked for."""
        return next(fit for fit in self.explanations if fit.types == self.decision.target)

    @property
    def tied_without(self) -> list[Candidate]:
        """What explains the curves as well as the best with what is asked for, without it."""
        of_target, aic = self.question.of_target, self.target.aic
        return [
            fit
            for fit in self.explanations
            if not of_target <= fit.types and abs(fit.aic - aic) < self.decision.margin
        ]

    def chi_squared(self, fit: Candidate) -> float:
        """Return χ² of an explanation at the noise that is told, which is not widened."""
        return fit.chi_squared_of([checked.widening for checked in self.judgements])

    @property
    def if_present(self) -> Mapping[str, Estimate]:
        """Modulus and quantities of what is asked for if it were there, though there is no sign."""
        if self.verdict is not Verdict.NO_SIGN or not self.question.of_target:
            return {}
        beside = next(fit for fit in self.tied if fit.types == self.question.of_target)
        own = {name: beside.parameters[name] for name in self.question.open_quantities}
        return {MODULUS: self.over_tied(MODULUS, self.tied)} | own

    def over_tied(self, name: str, tied: Sequence[Candidate] = ()) -> Estimate:
        """Return modulus (at the end of the loading) or tension over all that is tied.

        The interval is the least that contains theirs; without a lower end if one of them has none.
        The value is the one that all of them allow, NaN if there is none.  A tension that none of
        them has is held at 0 and has no ends: they do not bound it.  Where there is no sign of what
        is asked for, the modulus is that without it.
        """
        lacking = (
            self.question.of_target if name == MODULUS and self.verdict is Verdict.NO_SIGN else ()
        )
        tied = tied or [fit for fit in self.tied if not lacking or not lacking <= fit.types]
        tied = [fit for fit in tied if fit not in self.not_held]
        if name == MODULUS:
            tied = [fit for fit in tied if fit.holds_modulus]
        values = [fit.estimates[name] for fit in tied if name in fit.estimates]
        none = Estimate(0.0, None, None, "N/m", held=True)
        own = self.selected.parameters.get(name, none)
        if not values:
            another = (End.ANOTHER, End.ANOTHER)
            return own if tied or own.held else replace(own, low=None, high=None, ends=another)
        lows = [e.low for e in values if e.low is not None]
        highs = [e.high for e in values if e.high is not None]
        low = min(lows) if len(lows) == len(tied) else None
        high = max(highs) if len(highs) == len(values) else None
        ends = (
            _over([e.ends[0] for e in values], len(tied)),
            _over([e.ends[1] for e in values]),
        )
        # Of what some of them lack, and need not lack, no value is one that all allow.
        shared = len(values) == len(tied) or self.verdict is Verdict.NO_SIGN
        value = common_value(values) if shared else np.nan
        return Estimate(value, low, high, values[0].unit, ends=ends)


def _over(ends: Sequence[End], count: int = 0) -> End:
    """Return what an end is over several explanations, of which ``count`` should have one."""
    if len(ends) < count:
        return End.LACKING
    return next((end for end in ends if end is not End.CLOSED), End.CLOSED)


class Agreement(NamedTuple):
    """Rise of χ² where curves share quantities, over that of each curve on its own."""

    chi_squared: float
    degrees: int
    worst: int
    """The curve that agrees least."""

    @property
    def factor(self) -> float:
        """The factor by which it widens a rise of χ² (Birge 1932), 1 if it is within chance."""
        if not self.degrees or chdtrc(self.degrees, self.chi_squared) >= CHANCE:
            return 1.0
        return max(self.chi_squared / self.degrees, 1.0)


def agreement_of(fit: Candidate) -> Agreement:
    """Return whether curves agree on the quantities that they share."""
    count = len(fit.all_rows)
    shared = sum(slot.curve is None for slot in fit.objective.slots)
    if count == 1 or not shared:
        return Agreement(0.0, 0, 0)
    # What is weighed beside the rows does not scale with their noise.
    fit = fit.polish()
    objective = fit.of_rows
    values, rises = objective.values(fit.minimum.at), []
    for i in range(count):
        names = ("curves", "noise", "memory")
        alone = replace(objective, **{name: getattr(objective, name)[i : i + 1] for name in names})
        # A bead's own is that of the first curve that has the bead.
        of = (None, objective.beads[i], i)
        own = {(n, None if c is None else 0): v for (n, c), v in values.items() if c in of}
        start = alone.at_values(own)
        rises.append(alone.chi_squared(start) - alone.minimise(start).chi_squared)
    return Agreement(max(sum(rises), 0.0), shared * (count - 1), int(np.argmax(rises)))


def with_times(curves: Sequence[Curve]) -> tuple[Curve, ...]:
    """Return curves with times.

    Those whose times are not known have one speed, at which the longest takes 1 s.
    """
    ways = [np.append(0.0, np.cumsum(np.abs(np.diff(curve.base)))) for curve in curves]
    longest = max(way[-1] for way in ways)
    return tuple(
        curve if curve.time is not None else replace(curve, time=way / longest)
        for curve, way in zip(curves, ways, strict=True)
    )


@name_strangers()
def answer(
    curves: Sequence[Curve],
    model: Sequence[Effect],
    rivals: Iterable[Sequence[Effect]],
    *,
    common: Sequence[Effect] = (),
    fix: Mapping[str, float | str] | None = None,
    uncertainty: Sequence[Effect] = (),
    like: Sequence[Neighbour] = (),
) -> Answer:
    """Fit modulus, contact point and a model to curves of one solid, and weigh its rivals.

    The question is whether the first effect of the model that is none of the instrument is needed;
    its others, and ``common`` ones, are in all explanations.  Each set of rivals is compared alone
    and beside what is asked for.  ``fix`` has values of quantities of the solid, in SI or with
    units.  Effects of ``uncertainty``, whose quantities are weighed, widen intervals and are in no
    comparison.  What all curves that are ``like`` this one rule out is not compared, unless the
    choice then ties on none of them.

    Raises
    ------
    ConfigError, ConvergenceError, PluginError
        A value is not allowed, cantilever and solid do not balance, or a stranger's effect breaks
        its contract.
    """
    sets = tuple(map(tuple, rivals))
    for effect in (*model, *common, *chain(*sets), *uncertainty):
        refuse_broken(effect)
    curves = with_times(curves)
    target = next((effect for effect in model if not isinstance(effect, Records)), None)
    baseline = rivals_of(like[0].baseline if like else NONE, sets, common)
    common = (*common, *baseline)
    kept = (*common, *(effect for effect in model if effect is not target))
    question = Question(Solid.model_validate(dict(fix or {})), target, kept, sets)
    candidates, of_target = question.candidates(), question.of_target
    excused = {
        types: why
        for types, explanation in candidates.items()
        if (why := explanation.excuse(curves))
    }
    if of_target in excused:
        raise ConfigError(f"cannot be fitted to this curve: {excused[of_target]}", "model")
    candidates = {
        types: explanation for types, explanation in candidates.items() if types not in excused
    }
    spared = (
        frozenset[Types].intersection(*(neighbour.ruled_out for neighbour in like))
        if like
        else NONE
    )
    not_weighed = [t for t in candidates if t in spared and t not in (NONE, of_target)]
    weighed = {t: explanation for t, explanation in candidates.items() if t not in not_weighed}
    fits = dict(comparison(of_target, weighed, curves, like[0] if like else None))
    best = best_of(fits.values())
    inadequate = doubtful(best.judgements)
    again = partial(answer, curves, model, sets, fix=fix, uncertainty=uncertainty)
    needed = baseline_of(best, fits)
    # An offset may be all that a model of what the solid does lacks.
    tried = needed or frozenset({"offset"} if inadequate else ())
    if more := rivals_of(tried, sets, common):
        found = again(common=(*common, *more), like=like)
        if needed or found.verdict is not Verdict.UNDESCRIBED:
            return replace(found, baseline=(*baseline, *more, *found.baseline))
    threshold = threshold_of(min(checked.noise.freedom for checked in best.judgements))
    margin = max(MARGIN, threshold)
    decided = decision(fits, of_target, inadequate=inadequate, margin=margin)
    selected = choice(fits, of_target, decided)
    undescribed = decided.verdict is Verdict.UNDESCRIBED
    if not_weighed and not any(neighbour.has(selected, not undescribed) for neighbour in like):
        found = again(common=common)
        return replace(found, baseline=(*baseline, *found.baseline))
    agreement = agreement_of(fits[selected])
    threshold *= agreement.factor
    alone = {types: candidates.get(types - of_target) for types in excused if of_target < types}
    responses = {types: known.of(Responds) for types, known in alone.items() if known}
    untried = [types for types, own in responses.items() if any(e.type_name in types for e in own)]
    # Of what no model describes few ends are worth seeking; none if what may be right has no model.
    own = (MODULUS, TENSION, CONTACT_POINT, *question.open_quantities) if undescribed else ()
    rise, tied = (
        np.inf if undescribed and untried else threshold,
        ties(fits, of_target, decided, selected),
    )
    for types in tied:
        names = own if types == selected else (MODULUS, TENSION, *question.open_quantities)
        fits[types] = with_estimates(fits[types], rise, uncertainty, names)
    return Answer(
        tuple(sorted(fits.values(), key=lambda fit: fit.aic)),
        question,
        decided,
        fits[selected],
        tuple(fits[types] for types in tied),
        excused,
        tuple(best.judgements),
        threshold,
        agreement,
        tuple(untried),
        tuple(not_weighed),
        baseline,
        _elsewhere(question, fits, margin),
    )


def _elsewhere(
    question: Question, fits: Mapping[Types, Candidate], margin: float
) -> Candidate | None:
    """Return the best simple explanation that touches elsewhere than given, if it is so good."""
    if question.solid.contact_point is None:
        return None
    solid = question.solid.of_values({CONTACT_POINT: None})
    simple = {NONE: fits[NONE], question.of_target: fits[question.of_target]}
    of = [fit.objective.explanation for fit in simple.values()]
    free = dict(zip(simple, (replace(one, solid=solid) for one in of), strict=True))
    curves = tuple(replace(curve, touch=None) for curve in fits[NONE].all_rows)
    memory = fits[NONE].objective.memory
    elsewhere = best_of(comparison(question.of_target, free, curves, memory=memory).values())
    moved = frozenset({CONTACT_POINT})
    known = at_common_noise({**fits, moved: elsewhere})
    given, best = (best_of(known[t] for t in some).aic for some in (simple, fits))
    return elsewhere if known[moved].aic < min(given - MANY_MARGIN, best + margin) else None


def with_estimates(
    fit: Candidate, threshold: float, extra: Sequence[Effect], names: Sequence[str]
) -> Candidate:
    """Return an explanation with the estimates of some of its quantities, or of all."""
    fit = fit.polish()
    objective, minimum = fit.objective, fit.minimum
    accuracy = max(
        known.accuracy(curve) * curve.largest / noise
        for known, curve, noise in zip(fit.known, objective.curves, objective.noise, strict=True)
    )
    if extra:
        objective, at = fit.beside(extra)
        minimum = objective.minimise(at)
    minimum, intervals = estimates(objective, minimum, threshold * max(1.0, accuracy) ** 2, names)
    if extra:
        return replace(fit, estimates=intervals, calibration_minimum=(objective, minimum))
    return replace(fit, estimates=intervals, minimum=minimum)
