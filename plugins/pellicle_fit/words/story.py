"""What a laboratory reads of a fit: the numbers asked for, the verdict, what to do, remarks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from textwrap import wrap
from typing import Any

import numpy as np

from pellicle.units import decimal, readable
from pellicle_fit.dynamic import depths
from pellicle_fit.estimation.candidate import NONE, Candidate
from pellicle_fit.estimation.coordinates import CONTACT_POINT, MODULUS
from pellicle_fit.estimation.intervals import CONFIDENCE
from pellicle_fit.estimation.moduli import misfit
from pellicle_fit.estimation.noise import Flaw, is_straight
from pellicle_fit.files.measurement import Note
from pellicle_fit.record import Record
from pellicle_fit.selection.recipe import Answer
from pellicle_fit.selection.verdict import Verdict

from .names import in_figures, in_words, join_names, words, words_of, words_of_types

_WIDTH = 100
_WRAPPED: dict[str, Any] = {"subsequent_indent": "    ", "break_on_hyphens": False}
_LARGE = 0.5
"""Amplitude of a sine over its depth beyond which the stiffness is off by 1 %."""
_RIVALS = 3
"""Rivals that a verdict names."""
NOT_WEIGHED = (
    "not weighed beside tension: a surface more than half again as stiff as the bulk looks alike"
)


def story_lines(fit: Record, *, si: bool = False) -> list[str]:
    """Return the lines of its story for a terminal; a long one goes on, indented, after a ";"."""
    lines = list[str]()
    for line in story(fit, si=si):
        parts = [line] if len(line) <= _WIDTH else line.replace("; ", ";\n  ").splitlines()
        lines += chain.from_iterable(wrap(part, _WIDTH, **_WRAPPED) for part in parts)
    return lines


def story(fit: Record, *, si: bool = False) -> list[str]:
    """Return numbers, verdict, what it leaves out and what to do next; a line each."""
    caveat = [NOT_WEIGHED] if fit.data["tension_needed"] else []
    step = [f"next: {fit.advice}"] if fit.advice else []
    return [numbers(fit, si=si), fit.comparison, *_if_present(fit, si), *caveat, *step]


def _if_present(fit: Record, si: bool) -> Iterator[str]:
    """Yield what is known of what was asked for, and the modulus beside it, if it were there."""
    if present := fit.if_present:
        hidden = {"reduced_modulus"} if "youngs_modulus" in present else set()
        ordered = sorted(present, key=lambda name: name.endswith("_modulus"))
        parts = (f"{words(n)} {in_figures(present[n], si=si)}" for n in ordered if n not in hidden)
        yield f"if {fit.data['target']['words']} were there: {', '.join(parts)}"


def numbers(fit: Record, *, si: bool = False) -> str:
    """Return the quantities that were asked for, with intervals over all that fit as well.

    The modulus is Young's where Poisson's ratio is known.
    """
    estimates, known = fit.estimates(), fit.data["calibration"]
    modulus = "youngs_modulus" if "youngs_modulus" in estimates else "reduced_modulus"
    names = [modulus, *fit.data["target"]["quantities"]]
    parts = [f"{words(name)} {in_figures(estimates[name], si=si)}" for name in names]
    if fit.verdict is Verdict.UNDESCRIBED:
        return f"not to be quoted: {', '.join(parts)}; {known}"
    of_curves = "these speeds" if len(fit.curves) > 1 else "this speed"
    speed = f", at {of_curves}" if fit.data["at_this_speed"] else ""
    return f"{', '.join(parts)}, {100 * CONFIDENCE:.0f} %{speed}; {known}"


def calibration(uncertainty: Mapping[Any, float]) -> str:
    """Return to which uncertainties the calibration is known: exactly, if there are none."""
    known = shares(uncertainty)
    return f"calibration weighed: {known}" if known else "calibration taken as exact"


def shares(uncertainty: Mapping[Any, float]) -> str:
    """Return an uncertainty in words."""
    return join_names([f"{words(name)} to {100 * x:.3g} %" for name, x in uncertainty.items()])


def verdict_in_words(answer: Answer) -> str:
    """Return whether what is asked for is needed, with the strongest rival, in plain words."""
    curves = "these curves" if len(answer.judgements) > 1 else "this curve"
    reason = _reason(answer)
    return f"{headline(answer, curves)}{f': {reason}' if reason else ''}"


def headline(answer: Answer, curves: str = "") -> str:
    """Return the verdict without its reason, in a table without its subject, the ``curves``."""
    several = len(answer.judgements) > 1
    question, fits = answer.question, {fit.types: fit for fit in answer.explanations}
    of_target, target = question.of_target, answer.decision.target
    subject = words_of(fits[of_target]) if of_target else "an elastic half-space"
    if question.common and not of_target:
        subject += f" with {in_words(question.common)}"
    text = f"no sign of {subject if of_target else f'more than {subject}'}"
    match answer.verdict:
        case Verdict.UNDESCRIBED:
            text = f"no model describes {curves or 'it'}"
        case Verdict.NEEDED:
            pair = (
                f", beside {words_of_types(question, target - of_target)}"
                if target != of_target
                else ""
            )
            alone = "; no rival was tried" if fits.keys() <= {NONE, of_target} else ""
            text = f"{subject} is needed{pair}{alone}"
        case Verdict.CANNOT_TELL:
            names = _named(answer.tied_without)
            text = f"{curves} cannot tell {words_of(fits[target])} from {names}".lstrip()
        case Verdict.OTHER:
            alike = [fit for fit in answer.explanations if fit in answer.tied]
            better = [
                fit for fit in alike if not (of_target <= fit.types if of_target else not fit.types)
            ]
            shows = f"{curves} {'show' if several else 'shows'} more than {subject}".lstrip()
            known = f"{subject} is not needed" if of_target else shows
            text = f"{known}; described better by {_named(better)}"
        case _ if not of_target and len(fits) == 1:
            text = f"{subject} was compared with nothing"
    return text


def _reason(answer: Answer) -> str:
    """Return why that is the verdict; empty if its words say it."""
    question = answer.question
    if answer.verdict is Verdict.UNDESCRIBED:
        flaws = {flaw for check in answer.judgements if not check.describes for flaw in check.flaws}
        untried = join_names([words_of_types(question, types) for types in answer.untried])
        why = next(flaw.value for flaw in Flaw if flaw in flaws)
        return f"{why}; {untried} could not be tried" if untried else why
    fits = {fit.types: fit for fit in answer.explanations}
    if answer.verdict is Verdict.NEEDED and not fits.keys() <= {NONE, question.of_target}:
        other = answer.decision.other
        nearest = f"; the nearest is {words_of(fits[other])}" if other else ""
        return f"nothing else tried fits as well{nearest}"
    return ""


def _named(fits: Sequence[Candidate]) -> str:
    """Return explanations in words, but for those that only add to another of them."""
    simplest = [fit for fit in fits if not any(rival.types < fit.types for rival in fits)]
    return join_names([*map(words_of, simplest)], "or", _RIVALS)


def agreement(answer: Answer, names: Sequence[str]) -> str:
    """Return whether several curves agree on what they share; empty for one."""
    pool = answer.agreement
    if not pool.degrees:
        return ""
    if pool.factor == 1:
        return "the curves agree on what they share"
    wider = decimal(np.sqrt(pool.factor), 2)
    return (
        f"the curves do not agree on what they share, {names[pool.worst]} least of all; the "
        f"intervals are {wider} times wider for it"
    )


def _remarks_of_sines(answer: Answer) -> Iterator[str]:
    """Yield a warning of the sine that is explained worst, and of those that are not small."""
    selected = answer.selected
    for number, (known, curve) in enumerate(zip(selected.known, selected.all_rows, strict=True)):
        if far := misfit(selected, number):
            size = f"{100 * abs(far.off):.2g} % off that of {words_of(selected)}"
            yield f"the stiffness of the sine of {far.frequency:.4g} Hz is {size}"
        if curve.sines:
            for sine, depth in zip(curve.sines, depths(known, curve), strict=True):
                if sine.amplitude > _LARGE * depth:
                    share = f"{100 * sine.amplitude / depth:.2g} % of its depth"
                    way = f"the sine of {sine.frequency:.4g} Hz moves by {share}"
                    yield f"{way}: its contact does not stay, as K′ and K″ suppose"


def remarks(answer: Answer) -> Iterator[str]:
    """Yield warnings of what does without the modulus, and notes of what was added or left out."""
    if any(map(is_straight, answer.selected.all_rows)):
        yield "a straight line describes the forces as well: perhaps there is no contact"
    if fit := answer.elsewhere:
        known = (fit.parameters[name] for name in (CONTACT_POINT, MODULUS))
        place, modulus = (readable(e.value, e.unit, 3) for e in known)
        other = f"{words_of(fit)} with a modulus of {modulus}"
        yield f"the contact point is given, and may be wrong: with {place}, {other} would do"
    for fit in answer.not_held:
        modulus = readable(fit.estimates[MODULUS].value, "Pa", 3)
        yield f"the modulus is not held: with {words_of(fit)} one of {modulus} would do as well"
    yield from _remarks_of_sines(answer)
    if answer.baseline:
        yield Note(f"{in_words(answer.baseline)} was needed, and is fitted beside all else")
    reasons: dict[str, list[str]] = {}
    question = answer.question
    for types, reason in answer.excused.items():
        # Nothing is said of a rival that only beside what is asked could not be compared.
        if not (question.of_target and question.of_target <= types):
            reasons.setdefault(reason, []).append(words_of_types(question, types))
    if reasons:
        parts = (f"{join_names(names)} ({reason})" for reason, names in reasons.items())
        yield Note(f"not compared: {'; '.join(parts)}")
