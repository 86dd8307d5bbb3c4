"""What a laboratory reads of many fits: how many, their verdicts, and what to do next."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from pellicle.errors import first_of
from pellicle_fit.estimation.intervals import CONFIDENCE
from pellicle_fit.population.row import Row
from pellicle_fit.selection.neighbour import RULED_OUT

from .names import join_names
from .story import NOT_WEIGHED

_NAMES = 10
"""Curves that would be helped alike and are named."""
_STEPS = 6
"""Kinds of steps that are told, those that help most curves."""


def sentences_of_population(rows: Sequence[Row]) -> list[str]:
    """Return how many curves were fitted and accepted, their verdicts, and what to keep in mind."""
    fitted, accepted = sum(row.is_fitted for row in rows), sum(row.accepted for row in rows)
    counts = f"{fitted} of {len(rows)} curves were fitted"
    if accepted != fitted:
        counts += f", {accepted} of them accepted"
    verdicts, spared, needed, calibrations = Counter[str](), 0, False, dict[str, None]()
    for fit in (row.fit for row in rows if row.is_fitted):
        verdicts[fit.verdict.value] += 1
        spared += bool(fit.data.get("not_weighed"))
        needed = needed or bool(fit.data.get("tension_needed"))
        calibrations[fit.data["calibration"]] = None
    if verdicts:
        of = ", ".join(f"{verdict} in {count}" for verdict, count in verdicts.most_common())
        counts += f"; verdicts: {of}"
    sentences = [counts]
    if far := [row.name for row in rows if row.outlier]:
        sentences.append(
            f"far from the median modulus, and counted: {join_names(far, most=_NAMES)}"
        )
    if spared:
        sentences.append(
            f"in {spared} of them what curves beside them rule out by {RULED_OUT:.0f} in AIC was "
            "not compared; --every-rival compares it"
        )
    if needed:
        sentences.append(NOT_WEIGHED)
    level = f"intervals of {100 * CONFIDENCE:.0f} %"
    return [*sentences, *(f"{level}; {text}" for text in calibrations)]


def advice_of_population(rows: Sequence[Row]) -> list[str]:
    """Return what to do next, a line for each kind of step with the curves that it would help."""
    kinds: dict[str, dict[str, dict[str, str]]] = {}
    for row in rows:
        for step in row.fit.steps:
            kinds.setdefault(step["kind"], {})[row.name] = step
    lines, fitted = [], sum(row.is_fitted for row in rows)
    for steps in sorted(kinds.values(), key=len, reverse=True)[:_STEPS]:
        (first, step), *others = steps.items()
        of = (
            f"all {fitted} curves"
            if len(steps) == fitted > 1
            else join_names([*steps], most=_NAMES)
        )
        example = "" if all(entry["why"] == step["why"] for _, entry in others) else f"{first}: "
        lines.append(f"{of}: {step['do']} ({example}{step['why']})")
    return lines


def by_text(pairs: Sequence[tuple[str, str]]) -> list[str]:
    """Return each text once, behind the curves that it is of."""
    curves_of_text = dict[str, list[str]]()
    for text, name in pairs:
        curves_of_text.setdefault(text, []).append(name)
    return [f"{first_of(names)}: {text}" for text, names in curves_of_text.items()]
