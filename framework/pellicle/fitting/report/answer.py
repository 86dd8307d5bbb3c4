"""The answer of a fit in one sentence, with units that read well."""

from __future__ import annotations

import numpy as np

from pellicle.fitting.many import FITTED, ManyFits
from pellicle.fitting.population.summary import ALL, Quartiles
from pellicle.fitting.result import FitResult
from pellicle.fitting.statistics.profile import CONFIDENCE, Estimate
from pellicle.units import axis_unit

_GROUPS = 4
"""Groups of a population that are named in a sentence; of more, only all curves are."""
_NAMES = {
    "youngs_modulus": "Young's modulus",
    "reduced_modulus": "reduced modulus",
    "tension": "tension",
    "contact_point": "contact point",
}


def answer(fit: FitResult) -> str:
    """Return modulus, tension and contact point with their intervals as a sentence.

    The modulus is Young's where Poisson's ratio is known.
    """
    estimates = fit.estimates()
    hidden = "reduced_modulus" if "youngs_modulus" in estimates else ""
    parts = [
        f"{name} {in_words(estimates[key])}"
        for key, name in _NAMES.items()
        if key in estimates and key != hidden
    ]
    text = f"{', '.join(parts[:-1])} and {parts[-1]}" if len(parts) > 1 else parts[0]
    return f"{text[0].upper()}{text[1:]}, with {100 * CONFIDENCE:.0f} % intervals."


def answer_of_population(fits: ManyFits) -> str:
    """Return how many curves were fitted and accepted, with the medians of each group.

    Of curves in groups the median over all means little, so it is left to the table. A median is
    followed by the quartiles. The modulus is Young's where Poisson's ratio is known.
    """
    rows = fits.rows
    fitted = sum(row["status"] == FITTED for row in rows)
    accepted = sum(row["accepted"] for row in rows)
    parts = fits.summary()
    outliers = sum(row["outlier"] for row in rows if row["accepted"])
    counts = f"{fitted} of {len(rows)} curves were fitted"
    if accepted != fitted:
        counts += f", {accepted} of them accepted"
    if outliers:
        counts += f"; the modulus of {outliers} stands out"
    hidden = "reduced_modulus" if any(p.parameter == "youngs_modulus" for p in parts) else ""
    groups = [group for group in dict.fromkeys(p.group for p in parts) if group != ALL]
    sentences = [f"{counts}."]
    for group in groups if 0 < len(groups) <= _GROUPS else [ALL] * bool(parts):
        medians = [
            f"{_NAMES.get(p.parameter, p.parameter.replace('_', ' '))} {_quartiles(p)}"
            for p in parts
            if p.group == group and p.parameter != hidden
        ]
        sentences.append(f"Median{'' if group == ALL else f' of {group}'}: {', '.join(medians)}.")
    if parts:
        sentences.append("In brackets the quartiles.")
    return " ".join(sentences)


def _quartiles(part: Quartiles) -> str:
    """Return a median with its quartiles: ``5 mN/m (4.8 to 5.2)``."""
    factor, unit = axis_unit(np.array([part.median or part.upper_quartile]), part.unit)
    median, low, high = (
        f"{value * factor:.3g}" for value in (part.median, part.lower_quartile, part.upper_quartile)
    )
    return f"{median} {unit} ({low} to {high})"


def in_words(estimate: Estimate) -> str:
    """Return an estimate with its interval: ``5 mN/m (4.8 to 5.2)``, or ``< 3.8 µN/m``."""
    factor, unit = scale(estimate)
    value = f"{estimate.value * factor:.4g} {unit}"
    if estimate.held:
        return f"fixed at {value}"
    if estimate.low is None and estimate.high is None:
        return "that this measurement does not determine"
    text = interval(estimate)
    return f"{text} {unit}" if None in (estimate.low, estimate.high) else f"{value} ({text})"


def interval(estimate: Estimate) -> str:
    """Return an interval in the unit of `scale`; of an open one the end that it has."""
    factor, _ = scale(estimate)
    if estimate.held:
        return "fixed"
    low, high = (
        None if end is None else f"{end * factor:.4g}" for end in (estimate.low, estimate.high)
    )
    if low is None and high is None:
        return "open"
    if low is None:
        return f"< {high}"
    return f"> {low}" if high is None else f"{low} to {high}"


def scale(estimate: Estimate) -> tuple[float, str]:
    """Return a factor and a prefixed unit for the value and the ends of an estimate."""
    ends = [end for end in (estimate.low, estimate.high) if end is not None]
    return axis_unit(np.array([estimate.value] if estimate.value else ends), estimate.unit)
