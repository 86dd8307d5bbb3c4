"""The answer of a fit in one sentence, with units that read well."""

from __future__ import annotations

from pellicle.fitting.parameters import CONTACT_POINT
from pellicle.fitting.result import FitResult
from pellicle.fitting.statistics.profile import CONFIDENCE
from pellicle.fitting.wording import in_words, words

_NAMES = "youngs_modulus", "reduced_modulus", "tension"


def answer(fit: FitResult, *, si: bool = False) -> str:
    """Return the estimates of the chosen model with their intervals as a sentence.

    It has the modulus, tension and contact point of an elastic solid under tension, and the
    parameters of another model if that is chosen.  The modulus is Young's where Poisson's ratio is
    known.
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
    return f"{text[0].upper()}{text[1:]}, with {100 * CONFIDENCE:.0f} % intervals{by}."
