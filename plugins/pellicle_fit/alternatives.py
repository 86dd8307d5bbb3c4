"""Intervals of modulus and tension over all explanations that curves cannot tell apart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from pellicle.units import readable

from .comparison import Comparison, RivalFit
from .models.adhesive import WORK_OF_ADHESION
from .models.relaxing import EXPONENT
from .parameters import CONTACT_POINT, MODULUS, OFFSET, SLOPE, TENSION, Parameter
from .statistics.chi_squared import ChiSquared, Minimum
from .statistics.profile import OPEN, Ends, Estimate, estimate_of, united
from .statistics.rivals import TENSED
from .wording import words

_ONE_SPEED = 1.5
"""Ratio of speeds up to which curves count as measured at one."""
_UNSEEN = {
    "tension+adhesion": (WORK_OF_ADHESION, "on approach {} would not show, on retraction it would"),
    "tension+power_law": (EXPONENT, "at one speed {} would not show, at a second it would"),
}
"""By the code of a pair, the parameter of its effect and what of it a measurement does not show."""
_NUISANCES = {CONTACT_POINT.name, OFFSET.name, SLOPE.name}
"""Parameters of every curve, whose values a comparison does not report."""


def over_alternatives(
    chi_squared: ChiSquared, comparison: Comparison, threshold: float
) -> Comparison:
    """Return the comparison with the intervals of modulus and tension over all alternatives."""
    if len(comparison.alternatives) < 2:
        return comparison
    is_needed = comparison.verdict == "needed"
    code = TENSED.code if comparison.chosen is None else comparison.chosen.rival.code
    chosen = next(fit for fit in comparison.alternatives if fit.rival.code == code)
    others = [fit for fit in comparison.alternatives if fit is not chosen]
    searched = [MODULUS, TENSION] if is_needed else [MODULUS]
    own = _estimates_of(chi_squared, chosen, threshold, searched)
    ends = {p: _in_coordinates(p, own[p.name]) for p in searched}
    for fit in others:
        closed = {p: known for p, known in ends.items() if known != OPEN}
        ends |= _extended(chi_squared, fit, threshold, closed)
    over_all = {}
    for parameter in searched:
        low, high = (None if end is None else parameter.value(end) for end in ends[parameter])
        over_all[parameter] = replace(own[parameter.name], low=low, high=high)
    comparison = replace(comparison, modulus=over_all[MODULUS])
    if not is_needed:
        return comparison
    comparison = replace(comparison, tension=over_all[TENSION])
    by_code = {fit.rival.code: fit for fit in others}
    hidden = []
    for code, (parameter, sentence) in _UNSEEN.items():
        if code in comparison.unseen and code in by_code:
            estimates = _estimates_of(chi_squared, by_code[code], threshold, [parameter])
            high = estimates[parameter.name].high
            hidden.append(sentence.format(_up_to(parameter.name, high, parameter.unit)))
    return replace(comparison, sentence="; ".join([comparison.sentence, *hidden]))


def _extended(
    chi_squared: ChiSquared, fit: RivalFit, threshold: float, ends: Mapping[Parameter, Ends]
) -> dict[Parameter, Ends]:
    """Return intervals of coordinates, extended to those of another explanation."""
    free = fit.rival.of(chi_squared).free
    fitted = {p: known for p, known in ends.items() if p in free}
    if fit.intervals == "profile":
        return {
            p: united(known, _in_coordinates(p, fit.estimates[p.name]))
            for p, known in fitted.items()
        }
    minimum = Minimum(fit.parameters, fit.chi_squared)
    return fit.rival.extended(chi_squared, minimum, threshold, fitted)


def _in_coordinates(parameter: Parameter, estimate: Estimate) -> Ends:
    """Return the interval of an estimate in coordinates of its parameter."""
    low, high = estimate.low, estimate.high
    return (
        None if low is None else parameter.coordinate(low),
        None if high is None else parameter.coordinate(high),
    )


def _up_to(name: str, high: float | None, unit: str) -> str:
    """Return what a parameter may be at most beside a tension, in words."""
    size = "" if high is None else f" up to {readable(high, unit, 2)}"
    return f"a {words(name)}{size} beside it"


def _estimates_of(
    chi_squared: ChiSquared, fit: RivalFit, threshold: float, searched: Sequence[Parameter]
) -> dict[str, Estimate]:
    """Return the estimates of an explanation, with intervals at least of those ``searched``."""
    if fit.intervals == "profile":
        return fit.estimates
    of_rival = fit.rival.of(chi_squared)
    minimum = Minimum(fit.parameters, fit.chi_squared)
    free = [p for p in searched if p in of_rival.free]
    minimum, ends = fit.rival.intervals(chi_squared, minimum, threshold, free)
    return reported_estimates(of_rival, minimum, ends)


def unseen_pairs(chi_squared: ChiSquared) -> tuple[str, ...]:
    """Return the codes of pairs that curves of this kind may need and do not show.

    Beside a tension approaches do not show a weak adhesion, nor those of one speed relaxation.
    Curves whose times are not known count as measured at one.
    """
    curves = chi_squared.members
    if any(curve.segment != "approach" for curve in curves):
        return ()
    speeds = [np.median(curve.history.velocity) for curve in curves if curve.time is not None]
    several = bool(speeds) and max(speeds) > _ONE_SPEED * min(speeds)
    if several or any(curve.history.dwells for curve in curves):
        return ("tension+adhesion",)
    return tuple(_UNSEEN)


def reported_parameters(chi_squared: ChiSquared) -> list[Parameter]:
    """Return the fitted parameters whose values a comparison reports."""
    return [p for p in chi_squared.parameters if p in chi_squared.free and p.name not in _NUISANCES]


def reported_estimates(
    chi_squared: ChiSquared, minimum: Minimum, ends: dict[Parameter, Ends]
) -> dict[str, Estimate]:
    """Return the estimates by name, without nuisances and a tension that is fixed."""
    bounds = chi_squared.deviations(minimum.parameters)
    return {
        p.name: estimate_of(p, chi_squared, minimum, ends.get(p, (None, None)), bounds)
        for p in chi_squared.parameters
        if p.name not in _NUISANCES and (p in chi_squared.free or p != TENSION)
    }
