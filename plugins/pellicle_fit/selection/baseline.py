"""What of the baseline of an instrument a curve shows, so that it acts beside all explanations."""

from collections.abc import Iterable, Sequence

from pellicle_fit.effect import Effect
from pellicle_fit.estimation.candidate import Candidate, Types
from pellicle_fit.estimation.noise import Flaw

from .verdict import MANY_MARGIN, Fits

_BASELINE = frozenset({"offset", "slope"})


def baseline_of(best: Candidate, fits: Fits, *, inadequate: bool) -> Types:
    """Return what of a baseline the best explanation needs, or shows to lack.

    It is of the instrument, and no rival of what the solid does, if nothing without it comes near:
    it then acts beside all.
    """
    # A slope may stand for what no model describes before an offset is taken off.
    for own in (best.types & _BASELINE, *([best.types & {"offset"}] if inadequate else [])):
        others = [fit.aic for types, fit in fits.items() if not own <= types]
        if others and min(others) - best.aic >= MANY_MARGIN:
            return own
    lacks = any(Flaw.OFFSET in checked.flaws for checked in best.judgements)
    return frozenset({"offset"} if lacks else ()) - best.objective.explanation.types


def named(types: Types, rivals: Iterable[Sequence[Effect]]) -> tuple[Effect, ...]:
    """Return those of rivals that have some types."""
    effects = {effect.type_name: effect for rival in rivals for effect in rival}
    return tuple(effects[name] for name in sorted(types & effects.keys()))
