"""Explanations of curves compared: with and without what is asked for, alone and beside rivals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from .candidate import NONE, Candidate, Types, best_of
from .curve import Curve
from .effect import Adds, Effect, Records, Sizes, Solid
from .explanation import Explanation
from .noise import neighbour_noise
from .objective import ROUGH, Objective
from .starts import starts
from .verdict import Fits

Explanations = Mapping[Types, Explanation]
_SAME = 0.01
"""Difference of χ² that decides nothing."""
_ROWS, _FEW, _ROWS_OF_FEW = 400, 2, 12_000
"""Means that stand for the rows of each pass, where the force has no jumps, and those of a few
explanations."""
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

    @property
    def wanted(self) -> list[str]:
        """Open quantities of what is asked for and of what is kept, unless it is a baseline."""
        own = (e for e in (self.asked, *self.kept) if e and not isinstance(e, (Adds, Records)))
        return [name for effect in own for name in effect.open]

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
                # What derives from an effect that is kept is another form of it, in its place.
                other = tuple(k for k in self.kept if not any(isinstance(e, type(k)) for e in own))
                found.setdefault(types, Explanation(self.solid, other + own))
        return found


def comparison(
    word: Types, candidates: Explanations, curves: tuple[Curve, ...], memory: tuple[float, ...] = ()
) -> Fits:
    """Return all explanations at their least χ², at the noise of the best.

    Noise that is correlated counts as such, unless the best explanation then fails: a bent baseline
    is no noise, and differences of it would remove the contact.
    """
    noise = tuple(neighbour_noise(curve.force).deviation for curve in curves)
    sizes = Sizes.of_curve(curves[0])
    of = Objective(candidates[NONE], curves, noise, sizes, memory, sizes.time)
    rows = _ROWS if len(candidates) > _FEW else _ROWS_OF_FEW
    means = tuple(curve.binned(rows) for curve in curves)
    simple = _sought({types: candidates[types] for types in (NONE, word)}, word, {}, of, means)
    simple = at_common_noise(simple)
    best = best_of(simple.values())
    if not memory and any(found := tuple(judged.memory for judged in best.judgements)):
        fits = comparison(word, candidates, curves, found)
        other = best_of(fits.values())
        # What a wrong explanation leaves before contact may look like noise with a memory.
        if all(judged.describes for judged in other.judgements) and any(
            judged.memory for judged in other.without_memory.judgements
        ):
            return fits
    # Another noise only scales χ²; at last it is that of the best.
    fits = _sought(candidates, word, simple, best.of_rows, means)
    fits = at_common_noise({types: _restarted(fit, fits) for types, fit in fits.items()})
    # The modulus of the end of the loading is that after the time since the best first touch.
    best = best_of(fits.values())
    pairs = zip(best.whole, best.contact_points, strict=True)
    times = [curve.time_in_contact(point) for curve, point in pairs]
    time = float(np.exp(np.mean(np.log(times))))
    return {types: fit.relaxed_for(time) for types, fit in fits.items()}


def _sought(
    candidates: Explanations, word: Types, simple: Fits, of: Objective, means: tuple[Curve, ...]
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
        # A pair starts from its parts.
        at = starts(objective, parts, scan=not word < types or not word)
        idle = [_idle(types, word, objective, fits)] if simple else []
        fits[types] = Candidate(types, objective, objective.best(at, *idle), of.curves)
    return fits


def _idle(types: Types, word: Types, objective: Objective, fits: Fits) -> tuple[float, float]:
    """Return between which χ² an explanation decides nothing.

    It is then far behind the best, or behind one of its parts; worse than nothing at all it cannot
    be, which it mostly contains.
    """
    low, contained = min(fit.aic for fit in fits.values()) + _FAR, [fits[NONE]]
    if word < types:
        contained = [fits[part] for part in (word, types - word) if part in fits]
        low = min(low, *(fit.aic + 1 for fit in contained))
    high = min(fit.chi_squared for fit in contained)
    simple = fits[word]
    is_whole = objective.curves is simple.whole
    # Of means, χ² lacks the scatter of the rows about them.
    scatter = 0.0 if is_whole else simple.chi_squared - simple.minimum.chi_squared
    return low - objective.criterion(0.0) - scatter, high - scatter + _SAME


def at_common_noise(fits: Fits) -> Fits:
    """Return explanations at the noise of the best that passes its checks.

    If none does, at that of the best, which is widened where it fails.
    """
    ranked = sorted(fits.values(), key=lambda fit: fit.aic)
    passing = (fit for fit in ranked if all(judged.describes for judged in fit.judgements))
    noise = [judged.noise.deviation for judged in next(passing, ranked[0]).judgements]
    return {types: fit.at_noise(noise) for types, fit in fits.items()}


def _restarted(fit: Candidate, fits: Fits) -> Candidate:
    """Return the least χ² from the minima of what it is a part of, too."""
    found = [fit.minimum]
    for whole in (other for types, other in fits.items() if fit.types and fit.types < types):
        start = fit.objective.at_values(whole.objective.values(whole.minimum.at))
        rough = fit.objective.minimise(start, steps=ROUGH)
        if rough.chi_squared < fit.minimum.chi_squared - 0.1:
            found.append(fit.objective.minimise(rough.at))
    return replace(fit, minimum=min(found, key=lambda minimum: minimum.chi_squared))
