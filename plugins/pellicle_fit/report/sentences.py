"""The results of fits in sentences, with units that read well."""

from __future__ import annotations

from collections import Counter

from pellicle_fit.intervals import CONFIDENCE
from pellicle_fit.population.fits import ManyFits
from pellicle_fit.population.summary import ALL, QUARTILES, summary
from pellicle_fit.result import Fit
from pellicle_fit.sentences import words as words_of
from pellicle_fit.wording import OVER_TIED, in_words, unit_of, words

_GROUPS = 4
"""Groups of a population that are named in a sentence; of more, only all curves are."""


def sentence_of_fit(fit: Fit, *, si: bool = False) -> str:
    """Return modulus and tension with their intervals, and what the chosen explanation adds.

    The modulus is Young's where Poisson's ratio is known.
    """
    estimates, chosen = fit.estimates(), fit.answer.chosen
    own = (e for e in chosen.objective.explanation.effects if e.type_name in chosen.types)
    others = [name for effect in own for name in effect.open if name not in OVER_TIED]
    hidden = {"reduced_modulus"} if "youngs_modulus" in estimates else set()
    if fit.tension.held and not fit.tension.value:
        hidden.add("tension")
    names = [name for name in OVER_TIED if name in estimates and name not in hidden]
    names += [*others, *(["contact_point"] if len(fit.members) == 1 else [])]
    parts = [f"{words(name)} {in_words(estimates[name], si=si)}" for name in names]
    text = " and ".join(filter(None, [", ".join(parts[:-1]), parts[-1]]))
    by = "" if chosen.types == fit.answer.question.word else f", by {words_of(chosen)}"
    tied = len(fit.answer.tied)
    over = f", over {tied} explanations that the data cannot tell apart" if tied > 1 else ""
    return f"{text[0].upper()}{text[1:]}, with {100 * CONFIDENCE:.0f} % intervals{over}{by}."


def sentences_of_population(fits: ManyFits) -> str:
    """Return how many curves were fitted and accepted, with the medians of each group.

    Of curves in groups the median over all means little, so it is left to the table. A median is
    followed by the quartiles. The modulus is Young's where Poisson's ratio is known.
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
    hidden = "reduced_modulus" * any(part["parameter"] == "youngs_modulus" for part in parts)
    groups = [group for group in dict.fromkeys(part["group"] for part in parts) if group != ALL]
    sentences = [f"{counts}."]
    for group in groups if 0 < len(groups) <= _GROUPS else [ALL] * bool(parts):
        medians = []
        for part in parts:
            if part["group"] == group and part["parameter"] != hidden:
                quartiles = [part[name] for name in QUARTILES[1:4]]
                unit = unit_of([quartiles[1] or quartiles[2]], part["unit"])
                low, median, high = (unit.number(value, 3) for value in quartiles)
                rest = f"; open in {part['open']} of {part['n']}" if part["open"] else ""
                text = f"{unit.with_unit(median)} ({low} to {high}{rest})"
                medians.append(f"{words(part['parameter'])} {text}")
        sentences.append(f"Median{'' if group == ALL else f' of {group}'}: {', '.join(medians)}.")
    return " ".join([*sentences, *["In brackets the quartiles."] * bool(parts)])
