"""Explanations of curves compared: which quantities and effects are needed."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from scipy.special import bdtrc

from pellicle.arrays import Array

from .curve import Curve
from .effect import Effect, Responds, Sizes
from .explanation import Explanation, Solid
from .intervals import Estimate
from .noise import Flaw, Judged, judged, neighbour_noise
from .objective import ROUGH, Minimum, Objective
from .starts import starts

MARGIN = 4.0
"""Difference of AIC below which explanations cannot be told apart."""
EFFECT_MARGIN = 6.0
"""Difference of AIC by which an effect must beat its absence: chance does so in 0.2 %."""
MANY_MARGIN = 12.0
"""Difference of AIC by which the best of many rivals must beat no effect at all."""
_FAILING = 0.01
"""Probability that a curve without fault fails some check."""
_RARE = 0.05
"""Probability below which the number of failing curves is not attributed to chance."""
_SAME = 0.01
"""Difference of χ² that decides nothing."""
_REFINED = 2
"""How often means are corrected by the explanation that is fitted to them."""
_FAR = 40.0
"""Difference of AIC beyond which an explanation is not sought to the end."""
_ROWS = 250
"""Means that stand for the rows of each pass, where the force has no jumps."""
Types = frozenset[str]
"""Types of a set of effects."""
NONE: Types = frozenset()


class Verdict(Enum):
    """The answer to whether a model is needed."""

    NEEDED = "needed"
    CANNOT_TELL = "cannot tell"
    NO_SIGN = "no sign"
    OTHER = "another explanation is better"
    UNDESCRIBED = "no model describes"


@dataclass(frozen=True, eq=False)
class Explained:
    """An explanation at its least χ²."""

    types: Types
    """Types of its effects, but for those that all explanations have."""
    objective: Objective
    minimum: Minimum
    whole: tuple[Curve, ...]
    """The curves with all their rows."""
    estimates: Mapping[str, Estimate] = field(default_factory=dict)
    """Of the chosen explanation all, of those tied with it modulus and tension."""

    @property
    def aic(self) -> float:
        """Akaike's criterion, less a constant of the curves."""
        return criterion(self.objective, self.chi_squared)

    @cached_property
    def of_rows(self) -> Objective:
        """χ² of all rows as a function of its quantities."""
        return replace(self.objective, curves=self.whole)

    @cached_property
    def chi_squared(self) -> float:
        """χ² of all rows."""
        return self.of_rows.chi_squared(self.minimum.at)

    def forces(self) -> list[Array]:
        """Return the force [N] at all rows of each curve."""
        return self.of_rows.forces(self.minimum.at)

    def refined(self) -> Explained:
        """Return the same at the least χ² of all rows, from means that lack nothing of it.

        A mean of a curved force is not the force at the mean position: what the explanation itself
        has in excess there is taken out of the measured means.
        """
        fit = self
        for _ in range(_REFINED):
            objective, at = fit.objective, fit.minimum.at
            rows, means = fit.forces(), objective.forces(at)
            curves = []
            parts = zip(fit.whole, objective.curves, rows, means, strict=True)
            for whole, curve, force, mean in parts:
                if curve.counts is None:
                    curves.append(whole)
                    continue
                left = replace(whole, force=whole.force - force, stiffness=None)
                measured = mean + left.binned(_ROWS).force
                tip = curve.base - (measured / curve.stiffness if curve.stiffness else 0.0)
                curves.append(replace(curve, force=measured, position=tip))
            objective = replace(objective, curves=tuple(curves))
            fit = replace(fit, objective=objective, minimum=objective.minimise(at))
        return fit

    def at_noise(self, noise: Sequence[float]) -> Explained:
        """Return the same at another noise [N] of each curve."""
        objective = self.objective.with_noise(noise)
        minimum = self.minimum._replace(chi_squared=objective.chi_squared(self.minimum.at))
        return replace(self, objective=objective, minimum=minimum)

    @cached_property
    def judgements(self) -> list[Judged]:
        """Noise and flaws of each curve under it, from all rows."""
        at, memory = self.minimum.at, self.objective.memory
        objective, forces = replace(self.of_rows, memory=()), self.forces()
        jacobian = objective.jacobian(at, range(at.size))
        # A coordinate at its limit is none that the fit could use.
        low, high = objective.limits
        jacobian = jacobian[:, (at > low) & (at < high)]
        found, row = [], 0
        rows_of = zip(objective.curves, forces, objective.noise, strict=True)
        for i, (curve, force, noise) in enumerate(rows_of):
            rows = slice(row, row + force.size)
            known = objective.known(at, i)
            depth = curve.base - known.solid.contact_point
            d = memory[i] if memory else 0.0
            one = judged(curve, curve.force - force, jacobian[rows] * noise, depth, d)
            if (
                np.max(curve.position) - known.solid.contact_point
                > known.contact(curve).depth_limit
            ):
                one = one._replace(flaws=one.flaws | {Flaw.TOO_DEEP})
            found.append(one)
            row += force.size
        return found


@dataclass(frozen=True)
class Question:
    """What is asked of curves: whether an effect is needed, beside others that are."""

    solid: Solid
    asked: Effect | None
    kept: tuple[Effect, ...]
    """Effects that all explanations have."""
    rivals: tuple[tuple[Effect, ...], ...]
    """Sets of effects, each compared alone and beside what is asked for."""

    @property
    def word(self) -> Types:
        """The set of what is asked for."""
        return frozenset({self.asked.type_name}) if self.asked else NONE

    def responds(self, types: Types) -> bool:
        """Return whether effects of some types are a response of the solid."""
        effects = (effect for rival in self.rivals for effect in rival)
        return any(isinstance(e, Responds) and e.type_name in types for e in effects)

    def candidates(self) -> dict[Types, Explanation]:
        """Return the explanations that are compared, by their types."""
        found: dict[Types, Explanation] = {}
        kept = {effect.type_name for effect in self.kept}
        sides: list[tuple[Effect, ...]] = [(), (self.asked,)] if self.asked else [()]
        for rival in ((), *self.rivals):
            for side in sides:
                taken = kept | {effect.type_name for effect in side}
                own = side + tuple(e for e in rival if e.type_name not in taken)
                types = frozenset(effect.type_name for effect in own)
                found.setdefault(types, Explanation(self.solid, self.kept + own))
        return found


class Decision(NamedTuple):
    """A verdict, the explanations that it rests on, and by how much."""

    verdict: Verdict
    asked: Types
    """The best explanation with what is asked for."""
    other: Types
    """The best without."""
    lead: float
    """AIC of the latter over that of the former."""


def decided(word: Types, fits: Sequence[Explained], *, doubted: bool, margin: float) -> Decision:
    """Return the verdict on explanations, the best of which fails its checks if ``doubted``."""
    aic = {fit.types: fit.aic for fit in fits}
    ranked = sorted(fits, key=lambda fit: fit.aic)
    # Beside another effect it explains the curves only if neither does as well alone.
    asked = next(
        fit.types
        for fit in ranked
        if fit.types == word or (word < fit.types and beats_parts(word, aic, fit))
    )
    other = next(fit.types for fit in ranked if not word <= fit.types or not word)
    lead = aic[other] - aic[asked]
    if doubted:
        verdict = Verdict.UNDESCRIBED
    elif aic[NONE] - aic[asked] < EFFECT_MARGIN:
        # The best of many rivals beats a clean curve by more than one of them does.
        better = aic[other] + MANY_MARGIN <= aic[NONE]
        verdict = Verdict.OTHER if better else Verdict.NO_SIGN
    elif abs(lead) >= margin:
        verdict = Verdict.NEEDED if lead > 0 else Verdict.OTHER
    else:
        verdict = Verdict.CANNOT_TELL
    return Decision(verdict, asked, other, lead)


def beats_parts(word: Types, aic: Mapping[Types, float], fit: Explained) -> bool:
    """Return whether a pair has less AIC than each of its parts by what chance does not bring.

    Of a dozen pairs that all see the same noise, some gain a little in many a curve.
    """
    single = fit.types - word
    return min(aic[word], aic.get(single, np.inf)) - fit.aic >= EFFECT_MARGIN


def chosen_of(word: Types, decision: Decision, fits: Sequence[Explained], margin: float) -> Types:
    """Return the explanation whose estimates count."""
    best = min(fits, key=lambda fit: fit.aic)
    if decision.verdict is Verdict.NEEDED:
        return decision.asked
    if decision.verdict is Verdict.OTHER:
        return decision.other
    if decision.verdict is Verdict.NO_SIGN:
        return word
    (model,) = (fit for fit in fits if fit.types == word)
    return word if model.aic - best.aic < margin else best.types


def lenders(
    word: Types, decision: Decision, chosen: Types, fits: Sequence[Explained], margin: float
) -> list[Explained]:
    """Return the explanations that the curves cannot tell from the best and that lend values.

    The best is one of those that the verdict weighs: a pair that is little better than its parts
    does not push out what ties with them.  Where there is no sign of what is asked for, what lacks
    it lends too.
    """
    aic = {fit.types: fit.aic for fit in fits}
    least = min(aic[decision.asked], aic[decision.other])

    def lends(fit: Explained) -> bool:
        effects = fit.objective.explanation.effects
        if decision.verdict is Verdict.NO_SIGN and not fit.types:
            return True
        if fit.aic - least >= margin or not all(effect.holds_modulus for effect in effects):
            return False
        if decision.verdict is Verdict.NO_SIGN:
            return fit.aic + EFFECT_MARGIN <= aic[NONE]
        return not word < fit.types or beats_parts(word, aic, fit)

    return [fit for fit in fits if fit.types == chosen or lends(fit)]


def fitted_all(
    question: Question, curves: tuple[Curve, ...]
) -> tuple[list[Explained], dict[Types, str]]:
    """Return all explanations at their least χ², at the noise of the best, and the excused.

    Noise that is correlated counts as such, unless the best explanation then fails: a bent baseline
    is no noise, and differences of it would remove the contact.
    """
    white = (0.0,) * len(curves)
    simple, _ = compared(question, curves, white, simple=True)
    best = min(simple, key=lambda fit: fit.aic)
    memory = tuple(judged.memory for judged in best.judgements)
    if any(memory):
        fits, excused = compared(question, curves, memory)
        if all(judged.describes for judged in min(fits, key=lambda fit: fit.aic).judgements):
            return fits, excused
    return compared(question, curves, white, {fit.types: fit for fit in simple})


def compared(
    question: Question,
    curves: tuple[Curve, ...],
    memory: tuple[float, ...],
    known: Mapping[Types, Explained] = MappingProxyType({}),
    *,
    simple: bool = False,
) -> tuple[list[Explained], dict[Types, str]]:
    """Return explanations, only those without rivals if ``simple``, and the excused.

    Some may be ``known`` already.  The noise is first that of neighbours, then that of the best of
    the simple ones, which only scales χ², and at last that of the best.
    """
    fits, word = dict(known), question.word
    excused: dict[Types, str] = {}
    candidates = question.candidates()
    first = [types for types in candidates if types in (NONE, word)]
    others = [types for types in candidates if types not in first]
    noise = [neighbour_noise(curve.force) for curve in curves]
    sizes = Sizes.of_curve(curves[0])
    means = curves if any(memory) else tuple(curve.binned(_ROWS) for curve in curves)
    for types in first if simple else first + others:
        explanation = candidates[types]
        if types in fits:
            continue
        if excuse := explanation.excuse(curves):
            excused[types] = excuse
            continue
        if types in others:
            noise = list(min(fits.values(), key=lambda fit: fit.aic).objective.noise)
        objective = Objective(explanation, curves, tuple(noise), sizes, memory)
        # No mean stands for rows of which some touch and others do not.
        jumps = objective.searched > 0
        objective = objective if jumps else replace(objective, curves=means)
        parts = [(fit.objective, fit.minimum) for part, fit in fits.items() if part < types]
        # A pair starts from its parts.
        scan = not word < types or not word
        idle = (np.inf, np.inf)
        if types in others:
            idle = _idle(types, word, objective, fits, jumps=jumps)
        minimum = objective.best(starts(objective, parts, scan=scan), idle)
        fits[types] = Explained(types, objective, minimum, curves)
        if len(fits) == len(first):
            fits = at_common_noise(fits.values())
    if simple:
        return list(fits.values()), excused
    better = [_restarted(fit, fits) for fit in fits.values()]
    return list(at_common_noise(better).values()), excused


def _idle(
    types: Types,
    word: Types,
    objective: Objective,
    fits: Mapping[Types, Explained],
    *,
    jumps: bool,
) -> tuple[float, float]:
    """Return between which χ² an explanation decides nothing.

    It is then far behind the best, or behind one of its parts; worse than nothing at all it cannot
    be, which it mostly contains.
    """
    low, contained = min(fit.aic for fit in fits.values()) + _FAR, [fits[NONE]]
    if word < types:
        contained = [fits[part] for part in (word, types - word) if part in fits]
        low = min(low, *(fit.aic + 1 for fit in contained))
    high = min(fit.chi_squared for fit in contained)
    # Of means, χ² lacks the scatter of the rows about them.
    scatter = 0.0 if jumps else fits[word].chi_squared - fits[word].minimum.chi_squared
    return low - criterion(objective, 0.0) - scatter, high - scatter + _SAME


def criterion(objective: Objective, chi_squared: float) -> float:
    """Return Akaike's criterion, less a constant of the curves."""
    return chi_squared + 2 * (len(objective.slots) + objective.searched)


def at_common_noise(fits: Collection[Explained]) -> dict[Types, Explained]:
    """Return explanations at the noise of the best that passes its checks.

    If none does, at that of the best, which is widened where it fails.
    """
    noise: list[float] = []
    for fit in sorted(fits, key=lambda fit: fit.aic):
        judgements = fit.judgements
        passes = all(judgement.describes for judgement in judgements)
        if passes or not noise:
            noise = [judgement.noise.deviation for judgement in judgements]
        if passes:
            break
    return {fit.types: fit.at_noise(noise) for fit in fits}


def _restarted(fit: Explained, fits: Mapping[Types, Explained]) -> Explained:
    """Return the least χ² from the minima of what it is a part of, too."""
    found = [fit.minimum]
    for whole in (other for types, other in fits.items() if fit.types and fit.types < types):
        start = fit.objective.at_values(whole.objective.values(whole.minimum.at))
        rough = fit.objective.minimise(start, steps=ROUGH)
        if rough.chi_squared < fit.minimum.chi_squared - 0.1:
            found.append(fit.objective.minimise(rough.at))
    return replace(fit, minimum=min(found, key=lambda minimum: minimum.chi_squared))


def doubtful(judgements: Sequence[Judged]) -> bool:
    """Return whether more curves fail than do so by chance."""
    failing = sum(not judgement.describes for judgement in judgements)
    return failing > 0 and bool(bdtrc(failing - 1, len(judgements), _FAILING) <= _RARE)
