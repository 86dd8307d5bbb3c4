"""The results of fits in sentences, with units that read well."""

from __future__ import annotations

import numpy as np

from pellicle.units import axis_unit
from pellicle_fit.many import FITTED, ManyFits
from pellicle_fit.parameters import CONTACT_POINT
from pellicle_fit.population.summary import ALL, Quartiles
from pellicle_fit.result import FitResult
from pellicle_fit.statistics.profile import CONFIDENCE
from pellicle_fit.wording import in_words, words

_GROUPS = 4
"""Groups of a population that are named in a sentence; of more, only all curves are."""
_NAMES = "youngs_modulus", "reduced_modulus", "tension"


def sentence_of_fit(fit: FitResult, *, si: bool = False) -> str:
    """Return the estimates of the chosen model with their intervals as a sentence.

    It has the modulus, tension and contact point of an elastic solid under tension, and the
    parameters of another model if that is chosen.  The modulus is Young's where Poisson's ratio is
    known; its range over other models follows if the curves cannot tell them apart.
    """
    estimates, chosen = fit.chosen_estimates(), fit.chosen
    names = [name for name in _NAMES if name in estimates]
    if chosen is None:
        names += [CONTACT_POINT.name] if CONTACT_POINT.name in estimates else []
    else:
        names += [name for name in estimates if name not in names]
    hidden = "reduced_modulus" if "youngs_modulus" in estimates else ""
    parts = [
        f"{words(name)} {in_words(estimates[name], si=si)}" for name in names if name != hidden
    ]
    text = f"{', '.join(parts[:-1])} and {parts[-1]}" if len(parts) > 1 else parts[0]
    by = "" if chosen is None else f", by {chosen.rival.words}"
    text = f"{text[0].upper()}{text[1:]}, with {100 * CONFIDENCE:.0f} % intervals{by}"
    return f"{'; '.join(filter(None, [text, fit.range_of_models(si=si)]))}."


def sentences_of_population(fits: ManyFits) -> str:
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
            f"{words(p.parameter)} {_quartiles(p)}"
            for p in parts
            if p.group == group and p.parameter != hidden
        ]
        sentences.append(f"Median{'' if group == ALL else f' of {group}'}: {', '.join(medians)}.")
    if parts:
        sentences.append("In brackets the quartiles.")
    return " ".join(sentences)


def _quartiles(part: Quartiles) -> str:
    """Return a median with its quartiles: ``5 mN/m (4.8 to 5.2)``."""
    scale = axis_unit(np.array([part.median or part.upper_quartile]), part.unit)
    median, low, high = (
        scale.number(value, 3) for value in (part.median, part.lower_quartile, part.upper_quartile)
    )
    rest = f"; open in {part.open} of {part.n}" if part.open else ""
    return f"{median} {scale.unit} ({low} to {high}{rest})"
