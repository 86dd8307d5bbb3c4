"""What a fit says in words: the verdict with its figures, failed checks, and what was left out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from pellicle.components import words_of_type
from pellicle.units import decimal, readable

from .candidate import NONE, Candidate, Types
from .effect import Effect
from .files.measurement import Note
from .forecast import telling, tightening
from .noise import Flaw, Judged
from .objective import MODULUS
from .recipe import TENSION, Answer
from .verdict import EFFECT_MARGIN, MARGIN, Verdict

_CHECKS = {
    Flaw.DIP: "the force dips before contact: something attracts, or the baseline bends",
    Flaw.OFFSET: "the force before contact is not 0: fit the baseline, with baseline 'offset'",
    Flaw.DRIFT: "the force before contact has a slope: fit it, with baseline 'slope'",
    Flaw.SLOW: "the noise before contact is correlated; intervals take it so",
    Flaw.SPIKES: "single points lie far from their neighbours, which is not normal noise and "
    "shifts the fit: leave them out",
    Flaw.STEPS: "the steps of the detector are coarser than the noise",
    Flaw.MISFIT: "in contact the residuals exceed the noise before it: intervals are widened",
    Flaw.PATTERN: "in contact the residuals follow a pattern: intervals are widened",
    Flaw.TOO_DEEP: "the depth is beyond that to which the force of this contact is known: are "
    "radius and units right?",
}
_MIMIC = "a surface more than half again as stiff as the bulk, which was not weighed, looks alike"
"""What bends curves as a tension does: both are a stiffness over the contact radius."""
_PLAUSIBLE = {MODULUS: (1.0, 1e12), TENSION: (0.0, 1.0), "thickness": (1e-9, 1.0)}
"""Values [SI] beyond which a unit is probably wrong."""
_PLAUSIBLE_DEPTH = 1e-5, 10.0
"""Depths over the radius likewise."""


def words(fit: Candidate) -> str:
    """Return the effects of an explanation in words, but for those that all have."""
    effects = fit.objective.explanation.effects
    return _in_words([effect for effect in effects if effect.type_name in fit.types])


def calibration(uncertainty: Mapping[str, float | str]) -> str:
    """Return to which uncertainties the calibration is known: exactly, if there are none."""
    known = [
        f"{name.replace('_', ' ')} to {value if isinstance(value, str) else f'{100 * value:.3g} %'}"
        for name, value in uncertainty.items()
    ]
    return f"calibration weighed: {_listed(known)}" if known else "calibration taken as exact"


def data(answer: Answer, uncertainty: Mapping[str, float | str]) -> str:
    """Return the number of rows, the noise, and how the calibration counts."""
    noise = [judged.noise.deviation for judged in answer.judgements]
    points = sum(curve.position.size for curve in answer.chosen.whole)
    ends = dict.fromkeys(readable(end, "N", 3) for end in (min(noise), max(noise)))
    curves = f"{len(noise)} curves, " if len(noise) > 1 else ""
    return f"{curves}{points} points, noise {' to '.join(ends)}; {calibration(uncertainty)}"


def comparison(answer: Answer) -> str:
    """Return the verdict with its figures."""
    curves, do = ("this curve", "does") if len(answer.judgements) == 1 else ("these curves", "do")
    fits = {fit.types: fit for fit in answer.explanations}
    (verdict, *sides, lead), word = answer.decision, answer.question.word
    asked, other, none = (fits[types] for types in (*sides, NONE))
    subject = words(fits[word]) if word else "an elastic half-space"
    if answer.question.kept and not word:
        subject += f" with {_in_words(answer.question.kept)}"
    gain = decimal(none.chi_squared - asked.chi_squared, 3), decimal(none.aic - asked.aic, 3)
    figures = "Δχ² = {}, ΔAIC = {}".format(*gain)
    if verdict is Verdict.UNDESCRIBED:
        flaws = {flaw for one in answer.judgements if not one.describes for flaw in one.flaws}
        codes = ", ".join(flaw.value for flaw in Flaw if flaw in flaws)
        text = (
            f"no model describes {curves}: that of least AIC is {words(answer.explanations[0])}, "
            f"and it fails a check ({codes})"
        )
        untried = _listed([_named(answer, types) for types in answer.untried])
        without = f"; {untried} could not be tried, so there are no intervals"
        return text + (without if untried else "")
    if verdict is Verdict.NEEDED:
        rival = f"ΔAIC = {decimal(lead, 3)} against {words(other)}, the best without it"
        if not answer.question.rivals:
            rival = "nothing else was compared"
        text = f"{subject} is needed ({figures} against none; {rival})"
        if asked.types != word:
            text += f"; the best is {words(asked)}"
        return text + (f"; {_MIMIC}" if word == {TENSION} else "")
    if verdict is Verdict.OTHER and none.aic - asked.aic < EFFECT_MARGIN and word:
        return f"{words(other)} describes {curves}, without {subject}"
    if verdict is Verdict.OTHER:
        text = (
            f"{words(other)} describes {curves} better than {words(asked) if word else subject} "
            f"(ΔAIC = {decimal(-lead, 3)})"
        )
        return f"{text}, so this is not evidence of {subject}" if word else text
    if verdict is Verdict.CANNOT_TELL:
        tied = [
            f"{words(fit)} (Δχ² = {decimal(fit.chi_squared - asked.chi_squared, 2)})"
            for fit in _tied_without(answer)
        ]
        return f"{curves} cannot tell {words(asked)} from {_listed(tied, 'or')}"
    if not word:
        if len(fits) == 1:
            return f"{subject} was compared with nothing"
        return f"{curves} {do} not show more than {subject}"
    text = f"{curves} {do} not show {subject} ({figures})"
    if word != {TENSION}:
        return text
    high = answer.tension.high
    bound = "nor set a bound on it" if high is None else f"it is below {readable(high, 'N/m', 3)}"
    return f"{text}; {bound}"


def advised(answer: Answer) -> str:
    """Return what to measure next; empty if nothing is open, or nothing would help."""
    if answer.verdict is Verdict.CANNOT_TELL:
        asked = next(f for f in answer.explanations if f.types == answer.decision.asked)
        advice, aim = telling(asked, _tied_without(answer)), "tell them apart"
        nothing = "no other speed, dwell, pass, depth or radius would tell them apart at this noise"
    else:
        found = {name: answer.estimates.get(name) for name in (MODULUS, TENSION)}
        names = [name for name, estimate in found.items() if estimate and estimate.high is None]
        advice, nothing = tightening(answer.chosen, names), ""
        aim = f"determine {_listed([name.replace('_', ' ') for name in names])}"
    count = f"{advice.count} curves of this kind" if advice.count > 1 else "this"
    return f"{count} would {aim}: {advice.words}" if advice.words else nothing


def agreement(answer: Answer, names: Sequence[str]) -> str:
    """Return whether several curves agree on what they share; empty for one."""
    found = answer.agreement
    if not found.degrees:
        return ""
    figures = (
        f"(Δχ² = {decimal(found.chi_squared, 3)} for {found.degrees} degrees of freedom against "
        "each on its own)"
    )
    if found.factor == 1:
        return f"the curves agree {figures}"
    return (
        f"the curves do not agree on what they share {figures}, {names[found.worst]} least of all; "
        f"the intervals are widened by {decimal(np.sqrt(found.factor), 2)}"
    )


def failed_checks(judged: Judged) -> list[tuple[str, str]]:
    """Return the code of each check that a curve fails, and what it says."""
    noise = readable(judged.noise.deviation, "N", 3)
    failed = [flaw for flaw in Flaw if flaw in judged.flaws]
    return [(flaw.value, f"{_CHECKS[flaw]} (noise {noise})") for flaw in failed]


def remarks(answer: Answer) -> Iterator[str]:
    """Yield warnings of what is not plausible, and notes of what was not compared."""
    chosen = answer.chosen
    for i, curve in enumerate(chosen.whole):
        radius = getattr(curve.indenter, "radius", None)
        point = chosen.objective.known(chosen.minimum.at, i).solid.contact_point
        depth = float(np.max(curve.position)) - point
        least, most = _PLAUSIBLE_DEPTH
        if radius and not least <= depth / radius <= most:
            yield (
                f"the depth of {readable(depth, 'm', 3)} is {depth / radius:.3g} times the radius "
                f"of {readable(radius, 'm', 3)}: are radius and units right?"
            )
    for name, (least, most) in _PLAUSIBLE.items():
        if (found := answer.estimates.get(name)) is None:
            continue
        # The best value of an open interval is one of many.
        low, high = found.low or 0.0, np.inf if found.high is None else found.high
        if low > most or high < least:
            value = readable(found.value, found.unit, 3)
            yield f"a {name.replace('_', ' ')} of {value} is not plausible: are the units right?"
    for fit in answer.not_held:
        modulus = readable(fit.estimates[MODULUS].value, "Pa", 3)
        yield (
            f"{words(fit)} would do with a reduced modulus of {modulus}, a small part of that of "
            "all others: beside it the data do not hold the modulus"
        )
    reasons: dict[str, list[str]] = {}
    word = answer.question.word
    for types, reason in answer.excused.items():
        # Nothing is said of a rival that only beside what is asked could not be compared.
        if not (word and word <= types):
            reasons.setdefault(reason, []).append(_named(answer, types))
    parts = (f"{_listed(names)} ({reason})" for reason, names in reasons.items())
    if reasons:
        yield Note(f"not compared: {'; '.join(parts)}")


def _tied_without(answer: Answer) -> list[Candidate]:
    """Return what explains the curves as well as the best with what is asked for, without it."""
    margin, word = max(MARGIN, answer.threshold), answer.question.word
    asked = next(fit for fit in answer.explanations if fit.types == answer.decision.asked)
    return [
        fit
        for fit in answer.explanations
        if not word <= fit.types and abs(fit.aic - asked.aic) < margin
    ]


def _named(answer: Answer, types: Types) -> str:
    """Return effects of the question in words."""
    asked, rivals = answer.question.asked, answer.question.rivals
    effects = {e.type_name: e for rival in rivals for e in rival}
    effects |= {asked.type_name: asked} if asked else {}
    return _in_words([effect for name, effect in effects.items() if name in types])


def _in_words(effects: Sequence[Effect]) -> str:
    return _listed([words_of_type(type(e), e.type_name) for e in effects]) or "no effect"


def _listed(names: Sequence[str], last: str = "and") -> str:
    return f" {last} ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))
