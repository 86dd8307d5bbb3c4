"""Explanations of curves compared: which quantities and effects are needed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.special import bdtrc

from pellicle.errors import ConfigError

from .curve import Curve
from .effect import Effect, Sizes
from .explanation import Explanation, Solid
from .intervals import Estimate
from .noise import Flaw, Judged, judged, neighbour_noise
from .objective import Minimum, Objective
from .starts import starts

MARGIN = 4.0
"""Difference of AIC below which explanations cannot be told apart."""
EFFECT_MARGIN = 6.0
"""Difference of AIC by which an effect must beat its absence: chance does so in 0.2 %."""
MANY_MARGIN = 12.0
"""Difference of AIC by which the best of many rivals must beat no effect at all."""
_PAIR_MARGIN = 2.0
"""Difference of AIC by which a pair has to beat each of its parts to lend its values."""
_FAILING = 0.01
"""Probability that a curve without fault fails some check."""
_RARE = 0.05
"""Probability below which the number of failing curves is not attributed to chance."""
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
    def words(self) -> str:
        """Its effects in words."""
        return self.objective.explanation.words

    @property
    def aic(self) -> float:
        """Akaike's criterion, less a constant of the curves."""
        effects, curves = self.objective.explanation.effects, self.objective.curves
        searched = sum(effect.searched(curve) for effect in effects for curve in curves)
        return self.chi_squared + 2 * (len(self.objective.slots) + searched)

    @cached_property
    def chi_squared(self) -> float:
        """χ² of all rows."""
        return replace(self.objective, curves=self.whole).chi_squared(self.minimum.at)

    def at_noise(self, noise: Sequence[float]) -> Explained:
        """Return the same at another noise [N] of each curve."""
        objective = self.objective.with_noise(noise)
        minimum = self.minimum._replace(chi_squared=objective.chi_squared(self.minimum.at))
        return replace(self, objective=objective, minimum=minimum)

    def judged(self) -> list[Judged]:
        """Return noise and flaws of each curve under it, from all rows."""
        at = self.minimum.at
        objective = replace(self.objective, curves=self.whole)
        forces = objective.forces(at)
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
            one = judged(curve, curve.force - force, jacobian[rows] * noise, depth)
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
        if fit.types == word or (word < fit.types and beats_parts(word, aic, fit, EFFECT_MARGIN))
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


def beats_parts(word: Types, aic: Mapping[Types, float], fit: Explained, margin: float) -> bool:
    """Return whether a pair has less AIC than each of its parts by a margin."""
    single = fit.types - word
    return min(aic[word], aic.get(single, np.inf)) - fit.aic >= margin


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
    """Return the explanations that the curves cannot tell from the best and that lend values."""
    aic = {fit.types: fit.aic for fit in fits}
    least = min(aic.values())

    def lends(fit: Explained) -> bool:
        effects = fit.objective.explanation.effects
        if fit.aic - least >= margin or not all(effect.holds_modulus for effect in effects):
            return False
        if decision.verdict is Verdict.NO_SIGN:
            return fit.aic + EFFECT_MARGIN <= aic[NONE]
        return not word < fit.types or beats_parts(word, aic, fit, _PAIR_MARGIN)

    return [fit for fit in fits if fit.types == chosen or lends(fit)]


def fitted_all(
    question: Question, curves: tuple[Curve, ...]
) -> tuple[list[Explained], dict[Types, str]]:
    """Return all explanations at their least χ², at the noise of the best, and the excused.

    The noise is first that of the model, which only scales χ²; then that of the best explanation.
    """
    fits: dict[Types, Explained] = {}
    excused: dict[Types, str] = {}
    noise: Sequence[float] = [neighbour_noise(curve.force) for curve in curves]
    candidates, word = question.candidates(), question.word
    simple = [types for types in candidates if types in (NONE, word)]
    sizes = Sizes.of_curve(curves[0])
    means = tuple(curve.binned(_ROWS) for curve in curves)
    for types in simple + [types for types in candidates if types not in simple]:
        explanation = candidates[types]
        if excuse := explanation.excuse(curves):
            if types in simple:
                raise ConfigError(f"does not suit: {explanation.words} {excuse}", "model")
            excused[types] = excuse
            continue
        jumps = any(effect.searched(c) for effect in explanation.effects for c in curves)
        objective = Objective(explanation, curves if jumps else means, tuple(noise), sizes)
        known = [(fit.objective, fit.minimum) for part, fit in fits.items() if part < types]
        # A pair starts from its parts.
        scan = not word < types or not word
        minimum = objective.best(starts(objective, known, scan=scan))
        fits[types] = Explained(types, objective, minimum, curves)
        if len(fits) == len(simple):
            noise = noise_of(min(fits.values(), key=lambda fit: fit.aic))
            fits = {types: fit.at_noise(noise) for types, fit in fits.items()}
    better = [_restarted(fit, fits) for fit in fits.values()]
    noise = noise_of(min(better, key=lambda fit: fit.aic))
    return [fit.at_noise(noise) for fit in better], excused


def _restarted(fit: Explained, fits: Mapping[Types, Explained]) -> Explained:
    """Return the least χ² from the minima of what it is a part of, too."""
    found = [fit.minimum]
    for whole in (other for types, other in fits.items() if fit.types and fit.types < types):
        start = fit.objective.at_values(whole.objective.values(whole.minimum.at))
        rough = fit.objective.minimise(start, rough=True)
        if rough.chi_squared < fit.minimum.chi_squared - 0.1:
            found.append(fit.objective.minimise(rough.at))
    return replace(fit, minimum=min(found, key=lambda minimum: minimum.chi_squared))


def noise_of(fit: Explained) -> list[float]:
    """Return the noise of each curve [N] under an explanation."""
    return [curve.noise.deviation for curve in fit.judged()]


def doubtful(judgements: Sequence[Judged]) -> bool:
    """Return whether more curves fail than do so by chance."""
    failing = sum(not judgement.describes for judgement in judgements)
    return failing > 0 and bool(bdtrc(failing - 1, len(judgements), _FAILING) <= _RARE)
