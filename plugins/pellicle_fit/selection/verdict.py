"""The verdict on explanations of curves: what is needed, and what the curves cannot tell apart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import Enum
from typing import NamedTuple

from scipy.special import bdtrc

from pellicle_fit.estimation.candidate import NONE, Candidate, Types, best_of
from pellicle_fit.estimation.coordinates import MODULUS
from pellicle_fit.estimation.noise import ResidualCheck

MARGIN = 4.0
"""Difference of AIC below which explanations cannot be told apart."""
EFFECT_MARGIN = 6.0
"""Difference of AIC by which an effect must beat its absence: chance does so in 0.2 %."""
MANY_MARGIN = 12.0
"""Difference of AIC by which the best of many rivals must beat no effect at all, and the best of
many pairs all that lacks what is asked for."""
BASELINE = frozenset({"offset", "slope"})
"""Effects of the instrument that say nothing of the solid."""
SMALL = 0.2
"""Share of the moduli of others below which an explanation says that E* is not held."""
Fits = Mapping[Types, Candidate]
"""Explanations by their types."""
_FAILING = 0.01
"""Probability that a curve without fault fails some check."""
_RARE = 0.05
"""Probability below which the number of failing curves is not attributed to chance."""


class Verdict(Enum):
    """The answer to whether a model is needed."""

    NEEDED = "needed"
    CANNOT_TELL = "cannot tell"
    NO_SIGN = "no sign"
    OTHER = "another explanation is better"
    UNDESCRIBED = "no model describes"


class Decision(NamedTuple):
    """A verdict, the explanations that it rests on, and by how much."""

    verdict: Verdict
    target: Types
    """The best explanation with what is asked for."""
    other: Types
    """The best without."""
    delta_aic: float
    """AIC of the latter over that of the former."""
    margin: float
    """ΔAIC below which explanations tie."""


def decision(fits: Fits, of_target: Types, *, inadequate: bool, margin: float) -> Decision:
    """Return the verdict on explanations, the best of which fails its checks if ``inadequate``."""
    ranked = sorted(fits.values(), key=lambda fit: fit.aic)
    # Beside another effect it explains the curves only if neither does as well alone.
    target = next(fit for fit in ranked if fit.types == of_target or leads(fit, of_target, fits))
    other = next(fit for fit in ranked if not of_target <= fit.types or not of_target)
    none, delta_aic = fits[NONE].aic, other.aic - target.aic
    if delta_aic > 0 and target.types != of_target:
        margin = max(margin, MANY_MARGIN)
    if inadequate:
        verdict = Verdict.UNDESCRIBED
    elif none - target.aic < EFFECT_MARGIN:
        # The best of many rivals beats a clean curve by more than one of them does.
        verdict = Verdict.OTHER if none - other.aic >= MANY_MARGIN else Verdict.NO_SIGN
    elif abs(delta_aic) >= margin:
        verdict = Verdict.NEEDED if delta_aic > 0 else Verdict.OTHER
    else:
        verdict = Verdict.CANNOT_TELL
    return Decision(verdict, target.types, other.types, delta_aic, margin)


def leads(pair: Candidate, of_target: Types, fits: Fits) -> bool:
    """Return whether a pair has less AIC than each of its parts by what chance does not bring.

    Of a dozen pairs that all see the same noise, some gain a little in many a curve; and one that
    does without the solid, whose E* is a small part of that without the rival, is no explanation.
    """
    if not of_target < pair.types:
        return False
    parts = [fits[part] for part in (of_target, pair.types - of_target) if part in fits]
    alone, beside = (fit.parameters[MODULUS].value for fit in (fits[of_target], pair))
    return beside >= SMALL * alone and min(part.aic for part in parts) - pair.aic >= EFFECT_MARGIN


def choice(fits: Fits, of_target: Types, decision: Decision) -> Types:
    """Return the explanation whose estimates count."""
    quiet = best_of(fit for types, fit in fits.items() if types <= BASELINE)
    none = quiet.types if fits[NONE].aic - quiet.aic >= MARGIN else NONE
    known = {Verdict.NEEDED: decision.target, Verdict.OTHER: decision.other, Verdict.NO_SIGN: none}
    best = best_of(fits.values())
    nearest = of_target if fits[of_target].aic - best.aic < decision.margin else best.types
    return known.get(decision.verdict, nearest)


def ties(fits: Fits, of_target: Types, decision: Decision, selected: Types) -> list[Types]:
    """Return the explanations that the curves cannot tell from the best and that lend values.

    The best is one of those that the verdict weighs: a pair that is little better than its parts
    does not push out what ties with them.  Where there is no sign of what is asked for, what has
    it alone lends its bounds.
    """
    none = decision.verdict is Verdict.NO_SIGN
    least = min(fits[decision.target].aic, fits[decision.other].aic)

    def lends(fit: Candidate) -> bool:
        if fit.types == selected or (none and fit.types == of_target):
            return True
        if fit.aic - least >= decision.margin or not fit.holds_modulus:
            return False
        if none:
            return fit.aic + EFFECT_MARGIN <= fits[NONE].aic
        return not of_target < fit.types or leads(fit, of_target, fits)

    return [fit.types for fit in fits.values() if lends(fit)]


def doubtful(judgements: Sequence[ResidualCheck]) -> bool:
    """Return whether more curves fail than do so by chance."""
    failing = sum(not judgement.describes for judgement in judgements)
    return failing > 0 and bool(bdtrc(failing - 1, len(judgements), _FAILING) <= _RARE)
