"""The verdict on a tension, from the criteria of the explanations of curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from pellicle.units import decimal

from .comparison import EFFECT_MARGIN, Comparison, RivalFit, Verdict
from .statistics.chi_squared import ChiSquared
from .statistics.experiments import advised
from .statistics.noise import FailedCheck, doubt_of_tension
from .statistics.rivals import MARGIN, NONE, TENSED, untried_beside_tension

MANY_MARGIN = 12.0
"""Difference of AIC by which the best of many rivals must beat no effect at all."""


class Decision(NamedTuple):
    """The verdict on a tension by the criteria of explanations."""

    verdict: Verdict
    tensed: str
    """Name of the best explanation with a tension."""
    other: str
    """Name of the best explanation without."""
    lead: float
    """AIC of the latter over that of the former."""


_UNWEIGHED = (
    "unless the sensitivity is off by some per cent, the tip is worn or the surface is stiffer "
    "than the bulk: these were not weighed, so check the sensitivity on a hard surface and the tip "
    "in an image"
)
"""What bends curves as a tension does and is no rival of it."""


def decision(
    aic: Mapping[str, float], *, doubted: bool, margin: float, elastic_fails: bool = False
) -> Decision:
    """Return the verdict on a tension by Akaike's criteria of explanations, by their names.

    ``doubted`` and ``elastic_fails`` tell whether the best, and an elastic solid under tension,
    fail a check of their residuals.  Explanations that differ by less than ``margin`` cannot be
    told apart.
    """
    ranked = sorted(aic, key=aic.__getitem__)

    def describes(code: str) -> bool:
        # A tension beside an effect explains the curves only if neither does as well alone.
        tension, _, effect = code.partition("+")
        alone = min(aic[TENSED.code], aic.get(effect, np.inf))
        return code == TENSED.code or (
            tension == TENSED.code and alone - aic[code] >= EFFECT_MARGIN
        )

    tensed = next(code for code in ranked if describes(code))
    other = next(code for code in ranked if code.partition("+")[0] != TENSED.code)
    lead = aic[other] - aic[tensed]
    verdict: Verdict = "undecided"
    if doubted:
        verdict = "other"
    elif aic[NONE.code] - aic[tensed] < EFFECT_MARGIN:
        # The best of many rivals beats a clean curve by more than one of them does.
        verdict = "other" if aic[other] + MANY_MARGIN <= aic[NONE.code] else "not shown"
    elif abs(lead) >= margin and not (elastic_fails and lead > 0):
        verdict = "needed" if lead > 0 else "other"
    return Decision(verdict, tensed, other, lead)


def judge(
    chi_squared: ChiSquared,
    fits: Sequence[RivalFit],
    failed: Sequence[FailedCheck],
    threshold: float,
    elastic_fails: bool = False,
) -> Comparison:
    """Return the verdict on explanations of the curves of a χ².

    ``fits`` are sorted by their criterion; ``failed`` are the checks that the best one fails, and
    an elastic solid under tension may fail some; ``threshold`` is Δχ² at the ends of intervals.
    """
    # With noise from few rows intervals are wider, and that of a tension that is needed leaves 0
    # out.
    margin = max(MARGIN, threshold)
    by_code = {fit.rival.code: fit for fit in fits}
    doubted = bool(doubt_of_tension(failed))
    aic = {code: fit.aic for code, fit in by_code.items()}
    verdict, tensed_code, other_code, lead = decision(
        aic, doubted=doubted, margin=margin, elastic_fails=elastic_fails
    )
    tensed, other, none = by_code[tensed_code], by_code[other_code], by_code[NONE.code]
    curves = "this curve" if len(chi_squared.members) == 1 else "these curves"
    chosen: RivalFit | None = None
    sentence = advice = untried = ""
    if doubted or (verdict == "undecided" and lead >= margin):
        untried = untried_beside_tension(chi_squared)
    if doubted or verdict == "undecided":
        chosen = fits[0] if by_code[TENSED.code].aic >= margin else None
    if doubted:
        sentence = _undescribed(curves, fits[0], failed)
    elif verdict == "needed":
        chosen = tensed
        sentence = _needed(tensed, other, none, lead)
    elif verdict == "other":
        chosen = other
        sentence = f"{other.rival.words} describes {curves}, without tension"
        if none.aic - tensed.aic >= EFFECT_MARGIN:
            sentence = (
                f"{other.rival.words} describes {curves} better than {tensed.rival.words} "
                f"(ΔAIC = {decimal(-lead, 3)}), so this is not evidence of a tension"
            )
    elif verdict == "undecided" and lead >= margin:
        sentence = (
            f"{curves} cannot tell: {tensed.rival.words} is the best explanation (ΔAIC = "
            f"{decimal(lead, 3)} against {other.rival.words}, the best without tension), but a "
            "tension alone fails a check, so what else bends the force may stand for it too"
        )
    elif verdict == "undecided":
        without = [fit for fit in fits if not fit.rival.has_tension]
        tied = [fit for fit in without if abs(fit.aic - tensed.aic) < margin]
        names = [
            f"{fit.rival.words} (Δχ² = {decimal(fit.chi_squared - tensed.chi_squared, 2)})"
            for fit in tied
        ]
        sentence = f"{curves} cannot tell {tensed.rival.words} from {_listed(names)}"
        explanations = [(fit.rival, fit.parameters) for fit in (tensed, *tied)]
        advice = advised(chi_squared, explanations[0], explanations[1:])
    if untried:
        sentence = f"{sentence}; {untried}, so there are no intervals"
    if chosen is not None and chosen.rival == TENSED:
        chosen = None
    return Comparison(
        tuple(fits),
        verdict,
        sentence,
        advice,
        tuple(failed),
        chosen,
        margin=margin,
        untried=untried,
    )


def _undescribed(curves: str, best: RivalFit, failed: Sequence[FailedCheck]) -> str:
    """Return that no explanation describes the curves."""
    codes = ", ".join(dict.fromkeys(check.code for check in failed if check.of_model))
    sentence = (
        f"no model describes {curves}: that of least AIC is {best.rival.words}, and it fails a "
        f"check ({codes})"
    )
    if "adhesion" in {check.code for check in failed}:
        sentence += "; the force dips before contact, which is adhesion"
    return sentence


def _needed(tensed: RivalFit, other: RivalFit, none: RivalFit, lead: float) -> str:
    """Return by how much an explanation with tension beats none and the best without."""
    gain = none.chi_squared - tensed.chi_squared
    sentence = (
        f"tension is needed, {_UNWEIGHED} (Δχ² = {decimal(gain, 3)}, "
        f"ΔAIC = {decimal(none.aic - tensed.aic, 3)} against none; "
        f"ΔAIC = {decimal(lead, 3)} against {other.rival.words}, the best without it)"
    )
    if tensed.rival != TENSED:
        sentence += f"; beside it there is {tensed.rival.words.removeprefix('tension and ')}"
    return sentence


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} or {names[-1]}"
