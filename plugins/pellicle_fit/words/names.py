"""Names of explanations and quantities, and numbers with intervals, as people read them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pellicle.components import Column, words_of_type
from pellicle.units import DIGITS, Scale
from pellicle_fit.effect import Adds, Effect, Records
from pellicle_fit.estimation.candidate import Candidate, Types
from pellicle_fit.estimation.intervals import Estimate
from pellicle_fit.selection.rivals import Question

FEW = 3
"""Significant digits in sentences, and in tables of many curves."""
_SMALL = 1e-3
"""Size in a unit below which numbers have an exponent."""
_WORDS = {
    "youngs_modulus": "Young's modulus",
    "offset": "offset of the baseline",
    "slope": "slope of the baseline",
}


def words(name: str) -> str:
    """Return the name of a quantity or a key in words."""
    for key, text in _WORDS.items():
        name = name.replace(key, text)
    return name.replace("_", " ")


def words_of(fit: Candidate) -> str:
    """Return the effects of an explanation in words, but for those that all have."""
    effects = fit.objective.explanation.effects
    # A baseline that all have says nothing of the solid.
    of_solid = [effect for effect in effects if not isinstance(effect, (Adds, Records))]
    return in_words([e for e in effects if e.type_name in fit.types] or of_solid)


def words_of_types(question: Question, types: Types) -> str:
    """Return effects of a question in words."""
    effects = {effect.type_name: effect for rival in question.rivals for effect in rival}
    effects |= {question.target.type_name: question.target} if question.target else {}
    return in_words([effect for name, effect in effects.items() if name in types])


def in_words(effects: Sequence[Effect]) -> str:
    """Return effects that act together in words."""
    names = [words_of_type(type(effect), effect.type_name) for effect in effects]
    return " with ".join(names) or "an elastic half-space"


def join_names(names: Sequence[str], last: str = "and", most: int = 20) -> str:
    """Return names with commas and a word before the last; of many, how many more there are."""
    if len(names) > most + 1:
        names = [*names[:most], f"{len(names) - most} more"]
    return f" {last} ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))


def unit_of(values: Sequence[float], unit: str, *, si: bool = False) -> Scale:
    """Return the unit in which values in SI are shown, with one prefix unless ``si``."""
    return Column("", values, unit).unit_and_digits(si=si)[0]


def scale_of(estimate: Estimate, *, si: bool = False) -> Scale:
    """Return the unit for the value and the ends of an estimate, as `unit_of` does."""
    ends = [end for end in (estimate.low, estimate.high) if end is not None]
    # The value of an interval that is open to one side is not shown.
    is_quoted = estimate.value and not np.isnan(estimate.value)
    values = [estimate.value] if is_quoted and len(ends) != 1 else ends or [0.0]
    return unit_of(values, estimate.unit, si=si)


def interval(estimate: Estimate, unit: Scale, digits: int = DIGITS) -> str:
    """Return an interval in a unit; of an open one the end that it has."""
    if estimate.held:
        return "fixed"
    ends = (estimate.low, estimate.high)
    low, high = (None if end is None else unit.number(end, digits) for end in ends)
    if low is None:
        return "open" if high is None else f"< {high}"
    return f"> {low}" if high is None else f"{low} to {high}"


def value_and_ends(estimate: Estimate, unit: Scale, digits: int) -> tuple[str, str]:
    """Return value and interval of an estimate in a unit; no value of an open or a wide one."""
    low, high, value = estimate.low, estimate.high, estimate.value * unit.factor
    if estimate.is_narrow and abs(value) >= _SMALL and low is not None and high is not None:
        # As many decimals for all three, so that none seems to be another.
        places = max(digits - 1 - int(np.floor(np.log10(abs(value)))), 0)
        texts = (f"{number * unit.factor:.{places}f}" for number in (low, high))
        return f"{value:.{places}f}", " to ".join(texts)
    is_told = estimate.held or estimate.is_narrow
    told = unit.number(estimate.value, digits) if is_told else ""
    return told, interval(estimate, unit, digits)


def quote_estimate(estimate: Estimate, unit: Scale, digits: int, shown_unit: str = "") -> str:
    """Return an estimate with its interval, ``5.0 mN/m (4.8 to 5.2)``; of a wide one the ends."""
    value, ends = value_and_ends(estimate, unit, digits)
    if value:
        return f"{value}{shown_unit} ({ends})"
    is_open = estimate.low is None and estimate.high is None
    return "not determined" if is_open else f"{ends}{shown_unit}"


def in_figures(estimate: Estimate, *, si: bool = False) -> str:
    """Return an estimate with its interval and its unit."""
    unit = scale_of(estimate, si=si)
    return quote_estimate(estimate, unit, FEW, f" {unit.unit}".rstrip())
