"""Explanations of curves compared: with and without what is asked for, alone and beside rivals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from pellicle.arrays import Array
from pellicle_fit.contact.curve import Curve
from pellicle_fit.effect import Adds, Effect, Records, Sizes, Solid
from pellicle_fit.estimation.candidate import NONE, Candidate, Types, best_of
from pellicle_fit.estimation.noise import neighbour_noise
from pellicle_fit.estimation.objective import Objective
from pellicle_fit.estimation.search import Minimum, cost_of, descend
from pellicle_fit.estimation.starts import starts
from pellicle_fit.explanation import Explanation

from .neighbour import RULED_OUT, Neighbour
from .verdict import Fits

Explanations = Mapping[Types, Explanation]
_ROWS, _FEW, _ROWS_OF_FEW = 400, 2, 12_000
"""Means that stand for the rows of each pass, where the force has no jumps, and those of a few
explanations."""
_FAR, _NEAR, _LEADS, _BESIDE = RULED_OUT, 4.0, 2.0, 1.0
"""Differences of AIC to the best beyond which an explanation is given up, and not sought to all
digits; of a pair to its parts, and to the best."""
_STARTS, _STEPS, _KEPT = 6, 4, 2
"""Starts from which searches go, their rough steps, and how many are sought to the end."""
_LOUD = 0.1
"""Noise of the best over that at which it was sought below which all are sought again."""
_LOWER = 0.1
"""Fall of χ² that is worth another search."""
_COMPARED = 2e-2
"""Fall of χ² that is left where explanations are compared."""


@dataclass(frozen=True)
class Question:
    """What is asked of curves: whether an effect is needed, beside others that are."""

    solid: Solid
    target: Effect | None
    common: tuple[Effect, ...]
    """Effects that all explanations have."""
    rivals: tuple[tuple[Effect, ...], ...]
    """Sets of effects, each compared alone and beside what is asked for."""

    @property
    def of_target(self) -> Types:
        """The set of what is asked for."""
        return frozenset({self.target.type_name}) if self.target else NONE

    @property
    def open_quantities(self) -> list[str]:
        """Open quantities of what is asked for and of what is kept, unless it is a baseline."""
        own = (e for e in (self.target, *self.common) if e and not isinstance(e, (Adds, Records)))
        return [name for effect in own for name in effect.open]

    def candidates(self) -> dict[Types, Explanation]:
        """Return the explanations that are compared, by their types."""
        explanations: dict[Types, Explanation] = {}
        common = {effect.type_name for effect in self.common}
        sides: list[tuple[Effect, ...]] = [(), (self.target,)] if self.target else [()]
        for rival in ((), *self.rivals):
            for side in sides:
                taken = common | {effect.type_name for effect in side}
                own = side + tuple(e for e in rival if e.type_name not in taken)
                types = frozenset(effect.type_name for effect in own)
                # What derives from an effect that is kept is another form of it, in its place.
                remaining = tuple(
                    k for k in self.common if not any(isinstance(e, type(k)) for e in own)
                )
                explanations.setdefault(types, Explanation(self.solid, remaining + own))
        return explanations


def comparison(
    of_target: Types,
    candidates: Explanations,
    curves: tuple[Curve, ...],
    like: Neighbour | None = None,
    memory: tuple[float, ...] = (),
) -> Fits:
    """Return all explanations at their least χ², at the noise of the best.

    All but the simple ones are sought from what they are on a curve that is ``like`` these.
    Noise that is correlated counts as such, unless the best explanation then fails: a bent baseline
    is no noise, and differences of it would remove the contact.
    """
    noise = tuple(neighbour_noise(curve.force).deviation for curve in curves)
    sizes = Sizes.of_curve(curves[0])
    of = Objective(candidates[NONE], curves, sizes, sizes.time, noise, memory)
    rows = _ROWS if len(candidates) > _FEW else _ROWS_OF_FEW
    means = tuple(curve.bin_means(rows) for curve in curves)
    simple = _sought(
        {types: candidates[types] for types in (NONE, of_target)}, of_target, {}, of, means, None
    )
    simple = at_common_noise({types: fit.polish() for types, fit in simple.items()})
    best = best_of(simple.values())
    if not memory and any(memories := tuple(checked.memory for checked in best.judgements)):
        fits = comparison(of_target, candidates, curves, like, memories)
        best_with_memory = best_of(fits.values())
        # What a wrong explanation leaves before contact may look like noise with a memory.
        if all(checked.describes for checked in best_with_memory.judgements) and any(
            checked.memory for checked in best_with_memory.without_memory.judgements
        ):
            return fits
    fits = _compared(candidates, of_target, simple, means, like)
    # Beside so much noise a search ends far from the least χ² at that of the best.
    while _falls(best_of(simple.values()), best := best_of(fits.values())):
        simple = {types: fits[types] for types in (NONE, of_target, best.types)}
        simple[best.types] = best.polish()
        fits = _compared(candidates, of_target, simple, means, like)
    # The modulus of the end of the loading is that after the time since the best first touch.
    best = best_of(fits.values())
    pairs = zip(best.all_rows, best.contact_points, strict=True)
    times = [curve.time_in_contact(point) for curve, point in pairs]
    time = float(np.exp(np.mean(np.log(times))))
    return {types: fit.relaxed_for(time) for types, fit in fits.items()}


def _falls(before: Candidate, best: Candidate) -> bool:
    """Return whether the noise of a curve is a small part of what it was."""
    pairs = zip(before.objective.noise, best.objective.noise, strict=True)
    return any(now < _LOUD * then for then, now in pairs)


def _compared(
    candidates: Explanations,
    of_target: Types,
    simple: Fits,
    means: tuple[Curve, ...],
    like: Neighbour | None,
) -> Fits:
    """Return all explanations at the noise of the best, sought at that of the best simple one.

    Another noise only scales χ².
    """
    of = best_of(simple.values()).of_rows
    fits = _sought(candidates, of_target, simple, of, means, like)
    if like is None:
        fits = {types: _restarted(fit, of_target, fits) for types, fit in fits.items()}
    ends = {t: _end(t, of_target, fits, _NEAR) for t in fits}
    fits = {t: f.polish() if f.aic < ends[t] else f for t, f in fits.items()}
    return at_common_noise(_nearest_sought(fits, of_target))


def _sought(
    candidates: Explanations,
    of_target: Types,
    simple: Fits,
    of: Objective,
    means: tuple[Curve, ...],
    like: Neighbour | None,
) -> Fits:
    """Return explanations of all rows at their least χ², beside the simple ones if there are any.

    No mean stands for rows between which a force jumps, and none has their memory.
    """
    fits = dict(simple)
    for types, explanation in candidates.items():
        if types in fits:
            continue
        is_whole = any(of.memory) or any(effect.jumps for effect in explanation.effects)
        curves = of.curves if is_whole else means
        objective = replace(of, explanation=explanation, curves=curves)
        parts = [fit for part, fit in fits.items() if part < types]
        beside = fits.get(of_target if of_target <= types else NONE)
        at = near = like.starts(objective, types, beside, parts) if like and beside else []
        if not near:
            # A pair starts from its parts.
            at = starts(objective, parts, scan=not of_target < types or not of_target)
        goal = np.inf
        if simple:
            goal = _end(types, of_target, fits, _FAR) - objective.criterion(0.0)
        known = fits.get(of_target)
        least = _least(objective, at, goal, known, steps=0 if near else _STEPS)
        fits[types] = Candidate(types, objective, least, of.curves)
    return fits


def _nearest_sought(fits: Fits, of_target: Types) -> Fits:
    """Return explanations of which the best without what is asked for is sought to the end."""
    explanations, sought = dict(fits), set[Types]()
    while True:
        nearest = best_of(
            fit for fit in explanations.values() if not of_target or not of_target <= fit.types
        )
        if nearest.types in sought:
            return explanations
        explanations[nearest.types] = nearest.polish()
        sought.add(nearest.types)


def _end(types: Types, of_target: Types, fits: Fits, far: float) -> float:
    """Return the AIC above which an explanation decides nothing.

    It is then far behind the best, or no better than nothing at all; or, of a pair, neither the
    best nor ahead of its parts.
    """
    least = min(fit.aic for fit in fits.values())
    if not of_target < types:
        return min(least + far, fits[NONE].aic)
    of_parts = (
        min(fits[part].aic for part in (of_target, types - of_target) if part in fits) - _LEADS
    )
    return max(min(least + far, of_parts), least + _BESIDE)


def _least(
    objective: Objective,
    starts: Sequence[Array],
    goal: float,
    known: Candidate | None,
    steps: int = _STEPS,
) -> Minimum:
    """Return the least minimum from several starts: few ``steps`` of all, more of the best.

    One that does not come below a goal for χ² of all rows is given up.
    """
    coarse, of_means, of_coarse = objective.coarse, goal, goal
    if known is not None:
        of_means -= _scatter(known, objective.curves)
        of_coarse -= _scatter(known, coarse.curves)
    left = np.array(starts)
    most = _STARTS if steps else _KEPT
    if len(left) > most:
        terms = coarse.trials(np.clip(left, *coarse.limits)).terms
        left = left[np.argsort(cost_of(terms))[:most]]
    if len(left) > _KEPT:
        minima = descend(coarse, left, steps=steps, goal=of_coarse)
        minima.sort(key=lambda minimum: minimum.chi_squared)
        left = np.array([minimum.at for minimum in minima[:_KEPT]])
    minima = descend(objective, left, goal=of_means, fall=_COMPARED, rivals=True)
    return min(minima, key=lambda minimum: minimum.chi_squared)


def at_common_noise(fits: Fits) -> Fits:
    """Return explanations at the noise of the best that passes its checks.

    If none does, at that of the best, which is widened where it fails.
    """
    ranked = sorted(fits.values(), key=lambda fit: fit.aic)
    passing = (fit for fit in ranked if all(checked.describes for checked in fit.judgements))
    noise = [checked.noise.deviation for checked in next(passing, ranked[0]).judgements]
    return {types: fit.at_noise(noise) for types, fit in fits.items()}


@lru_cache(maxsize=4)
def _scatter(known: Candidate, curves: tuple[Curve, ...]) -> float:
    """Return by what χ² of all rows exceeds that of means: the scatter of the rows about them."""
    of_means = replace(known.objective, curves=curves)
    return known.chi_squared - of_means.chi_squared(known.minimum.at)


def _restarted(fit: Candidate, of_target: Types, fits: Fits) -> Candidate:
    """Return the least χ² from the minima of what it is a part of, too."""
    # What is no better than its part is no better place to start from.
    lower = fit.minimum.chi_squared - _LOWER
    wholes = [
        larger
        for types, larger in fits.items()
        if fit.types and fit.types < types and larger.minimum.chi_squared < lower
    ]
    if not wholes:
        return fit
    values = [whole.objective.values(whole.minimum.at) for whole in wholes]
    at = np.array([fit.objective.at_values(known) for known in values])
    goal = min(
        _end(fit.types, of_target, fits, _FAR) - fit.objective.criterion(0.0), fit.chi_squared
    )
    least = _least(fit.objective, [*at], goal - _LOWER, fits[of_target])
    return min(fit, replace(fit, minimum=least), key=lambda trial: trial.minimum.chi_squared)
