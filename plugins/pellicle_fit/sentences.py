"""What a fit says in words: the verdict with its figures, failed checks, and what was left out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pellicle.components import words_of_type
from pellicle.units import decimal, readable

from .files.measurement import Note
from .forecast import telling, tightening
from .noise import Flaw, Judged
from .objective import MODULUS
from .recipe import TENSION, Answer
from .rivals import EFFECT_MARGIN, MARGIN, NONE, Explained, Types, Verdict

_CHECKS = {
    Flaw.DIP: "the force dips before contact, which is adhesion or noise that is correlated",
    Flaw.OFFSET: "the force before contact is not 0: fit the baseline (baseline = offset)",
    Flaw.DRIFT: "the force before contact has a slope: fit the baseline (baseline = slope)",
    Flaw.SLOW: "the noise before contact is correlated, so the intervals are those of sums of it",
    Flaw.SPIKES: "single rows lie far from their neighbours: leave them out",
    Flaw.STEPS: "the steps of the detector are coarser than the noise",
    Flaw.MISFIT: "in contact the residuals exceed the noise before it",
    Flaw.PATTERN: "in contact the residuals follow a pattern",
    Flaw.TOO_DEEP: "the force of this contact is not known at the largest depth, and is "
    "continued from where it ends",
}
"""What a check says; the noise of the curve is added."""


def words(fit: Explained) -> str:
    """Return the effects of an explanation, but for those that all have, in words."""
    effects = [e for e in fit.objective.explanation.effects if e.type_name in fit.types]
    return " and ".join(words_of_type(type(e), e.type_name) for e in effects) or "no effect"


def calibration(uncertainty: Mapping[str, float | str]) -> str:
    """Return to which uncertainties the calibration is known: exactly, if there are none."""
    if not uncertainty:
        return "calibration taken as exact"
    known = [
        f"{name.replace('_', ' ')} to {value if isinstance(value, str) else f'{value:.3g}'}"
        for name, value in uncertainty.items()
    ]
    return f"calibration weighed: {_listed(known, 'and')}"


def data(answer: Answer, uncertainty: Mapping[str, float | str]) -> str:
    """Return the number of rows, the noise, and how the calibration counts."""
    noise = [judged.noise.deviation for judged in answer.judgements]
    points = sum(curve.position.size for curve in answer.chosen.whole)
    low, high = (readable(end, "N", 3) for end in (min(noise), max(noise)))
    curves = f"{len(noise)} curves, " if len(noise) > 1 else ""
    ends = low if low == high else f"{low} to {high}"
    return f"{curves}{points} points, noise {ends}; {calibration(uncertainty)}"


def comparison(answer: Answer) -> str:
    """Return the verdict with its figures."""
    fits = {fit.types: fit for fit in answer.explanations}
    curves, do = ("this curve", "does") if len(answer.judgements) == 1 else ("these curves", "do")
    decision, word = answer.decision, answer.question.word
    asked, other, none = fits[decision.asked], fits[decision.other], fits[NONE]
    gain = none.chi_squared - asked.chi_squared
    figures = f"Δχ² = {decimal(gain, 3)}, ΔAIC = {decimal(none.aic - asked.aic, 3)}"
    subject = words(fits[word]) if word else "an elastic half-space"
    if answer.verdict is Verdict.UNDESCRIBED:
        best = answer.explanations[0]
        flaws = sorted({flaw.value for one in answer.judgements for flaw in one.flaws})
        return f"no model describes {curves}: the best is {words(best)}, and {', '.join(flaws)}"
    if answer.verdict is Verdict.NEEDED:
        beside = [words(asked)] if asked.types != word else []
        return "; ".join(
            [
                f"{subject} is needed ({figures} against none; ΔAIC = {decimal(decision.lead, 3)} "
                f"against {words(other)}, the best without it)",
                *(f"the best explanation is {both}" for both in beside),
            ]
        )
    if answer.verdict is Verdict.OTHER:
        if not word:
            lead = decimal(none.aic - other.aic, 3)
            return f"{words(other)} describes {curves} better than {subject} (ΔAIC = {lead})"
        if none.aic - asked.aic < EFFECT_MARGIN:
            return f"{words(other)} describes {curves}, without {subject}"
        return (
            f"{words(other)} describes {curves} better than {words(asked)} "
            f"(ΔAIC = {decimal(-decision.lead, 3)}), so this is not evidence of {subject}"
        )
    if answer.verdict is Verdict.CANNOT_TELL:
        margin = max(MARGIN, answer.threshold)
        tied = [
            f"{words(fit)} (Δχ² = {decimal(fit.chi_squared - asked.chi_squared, 2)})"
            for fit in answer.explanations
            if not word <= fit.types and abs(fit.aic - asked.aic) < margin
        ]
        return f"{curves} cannot tell {words(asked)} from {_listed(tied, 'or')}"
    if not word:
        others = [fit for fit in answer.explanations if fit.types]
        if not others:
            return f"{subject} was compared with nothing"
        best = others[0]
        lead = decimal(none.aic - best.aic, 3)
        return f"{curves} {do} not show more than {subject} (ΔAIC = {lead} of {words(best)})"
    if word != {TENSION}:
        return f"{curves} {do} not show {subject} ({figures})"
    high = answer.tension.high
    bound = "nor set a bound on it" if high is None else f"it is below {readable(high, 'N/m', 3)}"
    return f"{curves} {do} not show tension ({figures}); {bound}"


def advised(answer: Answer) -> str:
    """Return what to measure next; empty if nothing is open, or nothing would help."""
    if answer.verdict is Verdict.CANNOT_TELL:
        asked, word = answer.decision.asked, answer.question.word
        fits = {fit.types: fit for fit in answer.explanations}
        margin = max(MARGIN, answer.threshold)
        others = [
            fit
            for fit in answer.explanations
            if not word <= fit.types and abs(fit.aic - fits[asked].aic) < margin
        ]
        advice, what = telling(fits[asked], others), "tell them apart"
        nothing = "no other speed, dwell, pass, depth or radius would tell them apart at this noise"
    else:
        open_ends = [
            name
            for name in (MODULUS, TENSION)
            if (found := answer.estimates.get(name)) and found.high is None
        ]
        advice, nothing = tightening(answer.chosen, open_ends), ""
        what = f"determine the {_listed([name.replace('_', ' ') for name in open_ends], 'and')}"
    if not advice.words:
        return nothing
    count = f"{advice.count} curves of this kind" if advice.count > 1 else "this"
    return f"{count} would {what}: {advice.words}"


def failed_checks(judged: Judged) -> list[tuple[str, str]]:
    """Return the code of each check that a curve fails, and what it says."""
    noise = readable(judged.noise.deviation, "N", 3)
    return [
        (flaw.name.lower(), f"{_CHECKS[flaw]} (noise of the fit: {noise})")
        for flaw in Flaw
        if flaw in judged.flaws
    ]


def remarks(answer: Answer) -> list[str]:
    """Return warnings and notes of a fit that are none of one of its curves."""
    found = [
        f"{words(fit)} would do with E* = "
        f"{readable(fit.estimates[MODULUS].value, 'Pa', 3)}, a small part of that of all others: "
        "with it the curve does not hold E*"
        for fit in answer.not_held
    ]
    reasons: dict[str, list[str]] = {}
    for types, reason in answer.excused.items():
        if not any(types - {*answer.question.word} == fit.types for fit in answer.explanations):
            reasons.setdefault(reason, []).append(_names(answer, types))
    if reasons:
        parts = (f"{_listed(names, 'and')} ({reason})" for reason, names in reasons.items())
        found.append(Note(f"not compared: {'; '.join(parts)}"))
    return found


def _names(answer: Answer, types: Types) -> str:
    """Return a set of effects in words, as the question has them."""
    effects = {e.type_name: e for rival in answer.question.rivals for e in rival}
    if answer.question.asked:
        effects[answer.question.asked.type_name] = answer.question.asked
    return " and ".join(words_of_type(type(effects[t]), t) for t in effects if t in types)


def _listed(names: Sequence[str], last: str) -> str:
    return f" {last} ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))
