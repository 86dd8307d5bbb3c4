"""Explanations of curves compared: with and without what is asked for, alone and beside rivals."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

from .candidate import NONE, ROWS, Candidate, Types, best_of, criterion
from .curve import Curve
from .effect import Effect, Responds, Sizes
from .explanation import Explanation, Solid
from .noise import neighbour_noise
from .objective import ROUGH, Objective
from .starts import starts

_SAME = 0.01
"""Difference of χ² that decides nothing."""
_FAR = 40.0
"""Difference of AIC beyond which an explanation is not sought to the end."""


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


def comparison(
    question: Question, candidates: Mapping[Types, Explanation], curves: tuple[Curve, ...]
) -> dict[Types, Candidate]:
    """Return all explanations at their least χ², at the noise of the best.

    Noise that is correlated counts as such, unless the best explanation then fails: a bent baseline
    is no noise, and differences of it would remove the contact.
    """
    white = (0.0,) * len(curves)
    simple = _simple(question, candidates, curves, white)
    memory = tuple(judged.memory for judged in best_of(simple.values()).judgements)
    if any(memory):
        fits = _beside(question, candidates, _simple(question, candidates, curves, memory))
        if all(judged.describes for judged in best_of(fits.values()).judgements):
            return fits
    return _beside(question, candidates, simple)


def _simple(
    question: Question,
    candidates: Mapping[Types, Explanation],
    curves: tuple[Curve, ...],
    memory: tuple[float, ...],
) -> dict[Types, Candidate]:
    """Return the explanations with and without what is asked for, at the noise of the best."""
    noise = tuple(neighbour_noise(curve.force) for curve in curves)
    fits: dict[Types, Candidate] = {}
    for types in dict.fromkeys((NONE, question.word)):
        objective = _objective(candidates[types], curves, noise, memory)
        parts = [(fit.objective, fit.minimum) for fit in fits.values()]
        minimum = objective.best(starts(objective, parts, scan=True))
        fits[types] = Candidate(types, objective, minimum, curves)
    return at_common_noise(fits.values())


def _beside(
    question: Question, candidates: Mapping[Types, Explanation], simple: Mapping[Types, Candidate]
) -> dict[Types, Candidate]:
    """Return all explanations: first at the noise of the best of the simple ones.

    That only scales χ²; at last it is that of the best.
    """
    fits, word = dict(simple), question.word
    best = best_of(simple.values())
    curves, noise, memory = best.whole, best.objective.noise, best.objective.memory
    for types, explanation in candidates.items():
        if types in fits:
            continue
        objective = _objective(explanation, curves, noise, memory)
        parts = [(fit.objective, fit.minimum) for part, fit in fits.items() if part < types]
        # A pair starts from its parts.
        scan = not word < types or not word
        idle = _idle(types, word, objective, fits)
        minimum = objective.best(starts(objective, parts, scan=scan), idle)
        fits[types] = Candidate(types, objective, minimum, curves)
    better = [_restarted(fit, fits) for fit in fits.values()]
    return at_common_noise(better)


def _objective(
    explanation: Explanation,
    curves: tuple[Curve, ...],
    noise: tuple[float, ...],
    memory: tuple[float, ...],
) -> Objective:
    """Return χ² of means, unless it has to be of all rows.

    No mean stands for rows between which a force jumps, and none has their memory.
    """
    objective = Objective(explanation, curves, noise, Sizes.of_curve(curves[0]), memory)
    if any(memory) or any(effect.jumps for effect in explanation.effects):
        return objective
    return replace(objective, curves=tuple(curve.binned(ROWS) for curve in curves))


def _idle(
    types: Types,
    word: Types,
    objective: Objective,
    fits: Mapping[Types, Candidate],
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
    scatter = (
        0.0
        if objective.curves is fits[word].whole
        else fits[word].chi_squared - fits[word].minimum.chi_squared
    )
    return low - criterion(objective, 0.0) - scatter, high - scatter + _SAME


def at_common_noise(fits: Collection[Candidate]) -> dict[Types, Candidate]:
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


def _restarted(fit: Candidate, fits: Mapping[Types, Candidate]) -> Candidate:
    """Return the least χ² from the minima of what it is a part of, too."""
    found = [fit.minimum]
    for whole in (other for types, other in fits.items() if fit.types and fit.types < types):
        start = fit.objective.at_values(whole.objective.values(whole.minimum.at))
        rough = fit.objective.minimise(start, steps=ROUGH)
        if rough.chi_squared < fit.minimum.chi_squared - 0.1:
            found.append(fit.objective.minimise(rough.at))
    return replace(fit, minimum=min(found, key=lambda minimum: minimum.chi_squared))
