"""What of the baseline of an instrument a curve shows, so that it acts beside all explanations."""

from collections.abc import Iterable, Sequence

from pellicle_fit.effect import Effect
from pellicle_fit.estimation.candidate import NONE, Candidate, Types

from .verdict import BASELINE, MANY_MARGIN, Fits


def baseline_of(best: Candidate, fits: Fits) -> Types:
    """Return what of a baseline the best explanation needs, if nothing without it comes near.

    It is of the instrument, and then no rival of what the solid does: it acts beside all.  Where a
    slope comes with an offset but may be something else, it is weighed beside that.
    """
    for own in (best.types & BASELINE, best.types & {"offset"}):
        others = [fit.aic for types, fit in fits.items() if not own <= types]
        if others and min(others) - best.aic >= MANY_MARGIN:
            return own
    return NONE


def rivals_of(
    types: Types, rivals: Iterable[Sequence[Effect]], common: Iterable[Effect]
) -> tuple[Effect, ...]:
    """Return the rivals of some types that are not among the ``common`` effects yet."""
    effects = {effect.type_name: effect for rival in rivals for effect in rival}
    absent = types - {effect.type_name for effect in common}
    return tuple(effects[name] for name in sorted(absent & effects.keys()))
