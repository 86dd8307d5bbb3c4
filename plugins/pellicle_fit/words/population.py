"""What a laboratory reads of many fits: how many, their medians, and what to do next."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from pellicle_fit.population.fits import ManyFits
from pellicle_fit.population.row import Row
from pellicle_fit.population.summary import ALL, QUARTILES, summary
from pellicle_fit.recipe import TENSION

from .effects import listed
from .quantities import unit_of, words

_NAMES = 10
"""Curves that would be helped alike and are named."""
_GROUPS = 4
"""Groups of a population that are named in a sentence; of more, only all curves are."""


def sentences_of_population(fits: ManyFits) -> list[str]:
    """Return how many curves were fitted and accepted, then the medians of each group.

    Of curves in groups the median over all means little, so it is left to the table. The modulus is
    Young's where Poisson's ratio is known.
    """
    rows, parts = fits.rows, summary(fits.rows)
    fitted, accepted = sum(row.is_fitted for row in rows), sum(row.accepted for row in rows)
    counts = f"{fitted} of {len(rows)} curves were fitted"
    if accepted != fitted:
        counts += f", {accepted} of them accepted"
    if outliers := sum(row.outlier for row in rows):
        counts += f"; the modulus of {outliers} stands out"
    if verdicts := Counter(
        row.fit.get("verdict", "") for row in rows if row.accepted
    ).most_common():
        counts += f"; verdicts: {', '.join(f'{count} {verdict}' for verdict, count in verdicts)}"
    shown = {TENSION, *[part["parameter"] for part in parts if "modulus" in part["parameter"]][-1:]}
    groups = [group for group in dict.fromkeys(part["group"] for part in parts) if group != ALL]
    sentences = [counts]
    for group in groups if 0 < len(groups) <= _GROUPS else [ALL] * bool(parts):
        medians = []
        for part in parts:
            if part["group"] == group and part["parameter"] in shown:
                quartiles = [part[name] for name in QUARTILES[1:4]]
                unit = unit_of([quartiles[1] or quartiles[2]], part["unit"])
                low, median, high = (unit.number(value, 3) for value in quartiles)
                closed = part["n"] - part["open"]
                text = f"median {unit.with_unit(median)}, quartiles {low} to {high}, "
                text = f"{text}of {closed} of {part['curves']} curves" if closed else "bounds alone"
                medians.append(f"{words(part['parameter'])}: {text}")
        sentences.append(f"{'' if group == ALL else f'{group}: '}{'; '.join(medians)}")
    return sentences


def advice_of_population(rows: Sequence[Row]) -> list[str]:
    """Return what to do next, a line for each step with the curves that it would help."""
    found: dict[str, dict[str, str]] = {}
    for row in rows:
        for step in row.fit.get("next", ()):
            found.setdefault(step["do"], {})[row.name] = step["why"]
    lines, fitted = [], sum(row.is_fitted for row in rows)
    for do, whys in sorted(found.items(), key=lambda item: -len(item[1])):
        first, why = next(iter(whys.items()))
        short = {Path(name).name for name in whys}
        names = sorted(short) if len(short) == len(whys) else [*whys]
        which = f"all {fitted} curves" if len(whys) == fitted > 1 else listed(names, most=_NAMES)
        example = "" if {*whys.values()} == {why} else f"{first}: "
        lines.append(f"{which}: {do} ({example}{why})")
    return lines
