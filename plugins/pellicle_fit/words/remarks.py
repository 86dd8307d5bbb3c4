"""What is said of a fit beside its story: agreement of curves, what was left out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from pellicle.units import decimal, readable
from pellicle_fit.files.measurement import Note
from pellicle_fit.objective import MODULUS
from pellicle_fit.recipe import Answer

from .effects import listed, words, words_of_types


def agreement(answer: Answer, names: Sequence[str]) -> str:
    """Return whether several curves agree on what they share; empty for one."""
    found = answer.agreement
    if not found.degrees:
        return ""
    if found.factor == 1:
        return "the curves agree on what they share"
    wider = decimal(np.sqrt(found.factor), 2)
    return (
        f"the curves do not agree on what they share, {names[found.worst]} least of all; the "
        f"intervals are {wider} times wider for it"
    )


def remarks(answer: Answer) -> Iterator[str]:
    """Yield a warning of a modulus that is not held, and notes of what was not compared."""
    for fit in answer.not_held:
        modulus = readable(fit.estimates[MODULUS].value, "Pa", 3)
        yield f"the modulus is not held: with {words(fit)} one of {modulus} would do as well"
    if answer.tension_needed:
        yield Note("a surface more than half again as stiff as the bulk, not weighed, looks alike")
    reasons: dict[str, list[str]] = {}
    question = answer.question
    for types, reason in answer.excused.items():
        # Nothing is said of a rival that only beside what is asked could not be compared.
        if not (question.word and question.word <= types):
            reasons.setdefault(reason, []).append(words_of_types(question, types))
    if reasons:
        parts = (f"{listed(names)} ({reason})" for reason, names in reasons.items())
        yield Note(f"not compared: {'; '.join(parts)}")
