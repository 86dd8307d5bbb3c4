"""Explanations in words."""

from __future__ import annotations

from collections.abc import Sequence

from pellicle.components import words_of_type
from pellicle_fit.candidate import Candidate, Types
from pellicle_fit.effect import Adds, Effect, Records
from pellicle_fit.rivals import Question


def words(fit: Candidate) -> str:
    """Return the effects of an explanation in words, but for those that all have."""
    effects = fit.objective.explanation.effects
    # A baseline that all have says nothing of the solid.
    of_solid = [effect for effect in effects if not isinstance(effect, (Adds, Records))]
    return in_words([e for e in effects if e.type_name in fit.types] or of_solid)


def words_of_types(question: Question, types: Types) -> str:
    """Return effects of a question in words."""
    effects = {effect.type_name: effect for rival in question.rivals for effect in rival}
    effects |= {question.asked.type_name: question.asked} if question.asked else {}
    return in_words([effect for name, effect in effects.items() if name in types])


def in_words(effects: Sequence[Effect]) -> str:
    """Return effects that act together in words."""
    names = [words_of_type(type(effect), effect.type_name) for effect in effects]
    return listed(names, "with") or "an elastic half-space"


def listed(names: Sequence[str], last: str = "and", most: int = 20) -> str:
    """Return names with commas and a word before the last; of many, how many more there are."""
    if len(names) > most:
        names = [*names[:most], f"{len(names) - most} more"]
    return f" {last} ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))
