"""Profile likelihood: estimates, their confidence intervals, and the minimum without tension."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import stdtrit

from pellicle.errors import ConvergenceError
from pellicle.units import decimal, readable
from pellicle_fit.parameters import TENSION, Coordinates, Parameter

from .chi_squared import ChiSquared, Minimum, least

Ends = tuple[float | None, float | None]
"""Ends of a confidence interval; None for one that the curve does not determine."""
OPEN: Ends = (None, None)
"""An interval that the curve does not determine."""

CONFIDENCE = 0.95
_REACH = np.log(100.0)
"""Change of a logarithm, E* or τ₀, up to which an end of an interval is sought."""
_ACCURACY = 2e-3
"""Accuracy of an end, relative to its distance from the best value."""
_FIRST = 1e-2
"""First trial, as a share of the way to the limit, where the bound lies beyond the limit."""
_LEAST = 1e-12
"""Smallest share of the way to the limit that is resolved."""
_RESTARTS = 10
"""Largest number of searches for intervals, each from a minimum that the last improved."""
_FINE = 0.1
"""Error of a condensed χ² of which intervals are sought, in its unit."""
_IMPROVEMENT = 1e-3
"""Decrease of χ² by which another minimum counts as better."""


@dataclass(frozen=True)
class Estimate:
    """A parameter of a fit: its value and the 95 % interval of its profile likelihood."""

    value: float
    low: float | None
    """Lower end; None if the curve determines none (a tension may then be 0)."""
    high: float | None
    """Upper end; None if the curve determines none."""
    unit: str
    bound: float
    """Cramér–Rao bound at the value, as a standard deviation; 0 if fixed."""
    held: bool = False
    """Whether it was fixed, not fitted."""

    @property
    def only_end(self) -> str:
        """In words the end of an interval that has one, as "below 3 kPa"; else ""."""
        if self.low is None and self.high is not None:
            return f"below {readable(self.high, self.unit, 3)}"
        if self.high is None and self.low is not None:
            return f"above {readable(self.low, self.unit, 3)}"
        return ""

    def to_dict(self) -> dict[str, Any]:
        """Return JSON data, with None for an open end or a bound that is infinite."""
        return vars(self) | {"bound": self.bound if np.isfinite(self.bound) else None}

    def without_interval(self) -> Estimate:
        """Return the value alone."""
        return replace(self, low=None, high=None)

    def times(self, factor: float) -> Estimate:
        """Return the estimate of a multiple."""
        low, high = (None if end is None else end * factor for end in (self.low, self.high))
        value, bound = self.value * factor, self.bound * factor
        return replace(self, value=value, low=low, high=high, bound=bound)


class ImprovedMinimum(Exception):  # noqa: N818 - not an error: the search continues from there
    """Raised when a profile reaches a smaller χ² than the minimum it starts from."""

    def __init__(self, minimum: Minimum) -> None:
        super().__init__(minimum)
        self.minimum = minimum


@dataclass(frozen=True)
class ProfileResult:
    """Minima of χ² with and without tension, and confidence intervals."""

    likelihood: ChiSquared
    best: Minimum
    without_tension: Minimum
    """The minimum with the tension fixed at 0."""
    ends: Mapping[Parameter, Ends]
    """Intervals of coordinates: of log E* (E* in Pa) for the modulus."""
    bounds: Coordinates
    """Cramér–Rao bounds of the coordinates at the minimum, as standard deviations."""
    messages: tuple[str, ...]
    """By how much intervals were widened, and which could not be determined."""

    def estimate(self, parameter: Parameter) -> Estimate:
        """Return value, interval and bound of a parameter; E* itself for the modulus.

        Without an interval the ends are None.  Where the interval is narrower than the Cramér–Rao
        bound, that bound is infinite: it is that of a linear model, and this model is not linear.
        """
        ends = self.ends.get(parameter, (None, None))
        return estimate_of(parameter, self.likelihood, self.best, ends, self.bounds)


def estimate_of(
    parameter: Parameter, chi_squared: ChiSquared, best: Minimum, ends: Ends, bounds: Coordinates
) -> Estimate:
    """Return value, interval and bound of a parameter from its coordinates."""
    value, bound = best.parameters[parameter], bounds[parameter]
    fixed = parameter not in chi_squared.free
    low, high = (value, value) if fixed else ends
    lowest = parameter.minimum if low is None else low
    if high is not None and max(high - value, value - lowest) < bound:
        bound = np.inf
    value = parameter.value(value)
    low, high = (None if end is None else parameter.value(end) for end in (low, high))
    bound *= value if parameter.logarithmic else 1.0
    return Estimate(value, low, high, parameter.unit, bound, fixed)


def chi_squared_threshold(freedom: float) -> float:
    """Return Δχ² at the ends of an interval, for noise of that many degrees of freedom.

    It is the square of the two-sided quantile of Student's t: 3.84 if the noise is known exactly.
    """
    return float(stdtrit(freedom, (1 + CONFIDENCE) / 2) ** 2)


def profile_likelihood(
    likelihood: ChiSquared,
    best: Minimum,
    threshold: float,
    parameters: Sequence[Parameter],
    without_tension: Callable[[Minimum], Minimum],
    report: Callable[[str], None] = lambda stage: None,
) -> ProfileResult:
    """Return the minimum near ``best``, the one without tension, and intervals of ``parameters``.

    ``without_tension`` finds a minimum without tension from one with it.  The intervals end where
    the profile of χ² exceeds its minimum by ``threshold``, and are widened by the change of the
    estimates on coarser grids if the force curve is simulated.  ``report`` is called with the name
    of each step.
    """
    while True:
        report("without tension")
        without = without_tension(best)
        if TENSION in likelihood.free and without.chi_squared <= best.chi_squared + 1e-6:
            # Of equally good minima, this one has a tension of exactly 0.
            best = without
        try:
            ends, failures = profile_intervals(likelihood, best, threshold, parameters, report)
        except ImprovedMinimum as improved:
            again = likelihood.minimise(improved.minimum.parameters)
            best = least([again, improved.minimum])
        else:
            wider, messages = widen(ends, likelihood, best)
            if failures:
                messages += (
                    f"the search for the interval of {', '.join(failures)} did not converge, and "
                    "the interval is left open: the curve does not tell the parameters apart; fix "
                    "one of them, or fit less of the baseline",
                )
            bounds = likelihood.deviations(best.parameters)
            return ProfileResult(likelihood, best, without, wider, bounds, messages)


def profile_intervals(
    likelihood: ChiSquared,
    best: Minimum,
    threshold: float,
    parameters: Iterable[Parameter],
    report: Callable[[str], None] = lambda stage: None,
) -> tuple[dict[Parameter, Ends], list[str]]:
    """Return intervals of parameters, and the names of those whose search fails: they are open.

    Raises
    ------
    ImprovedMinimum
        A profile falls below ``best``.
    """
    ends: dict[Parameter, Ends] = {}
    failures = []
    for parameter in parameters:
        report(f"interval of {parameter.name}")
        try:
            ends[parameter] = confidence_interval(likelihood, best, parameter, threshold)
        except ConvergenceError:
            ends[parameter] = None, None
            failures.append(parameter.name)
    return ends, failures


def profiled(
    chi_squared: ChiSquared,
    minimum: Minimum,
    threshold: float,
    parameters: Sequence[Parameter],
) -> tuple[Minimum, dict[Parameter, Ends]]:
    """Return the minimum, which a profile may have improved, and intervals of profiles.

    They are those of a condensed χ² if the curve is long, and open if every search for them ends in
    a better minimum than the last.
    """
    for _ in range(_RESTARTS):
        thin, near = _condensed(chi_squared, minimum)
        try:
            return minimum, profile_intervals(thin, near, threshold, parameters)[0]
        except ImprovedMinimum as improved:
            again = chi_squared.minimise(improved.minimum.parameters, rough=True)
            # A minimum of the condensed χ² is none of the χ² of all rows.
            known = [improved.minimum] if thin is chi_squared else []
            minimum = least([minimum, again, *known])
    return minimum, {}


def united(one: Ends, other: Ends) -> Ends:
    """Return the least interval that contains two."""
    lows, highs = zip(one, other, strict=True)
    return (
        None if None in lows else min(low for low in lows if low is not None),
        None if None in highs else max(high for high in highs if high is not None),
    )


def extended(
    chi_squared: ChiSquared, minimum: Minimum, threshold: float, parameter: Parameter, ends: Ends
) -> Ends:
    """Return an interval, extended to where another profile is below its minimum + threshold."""
    thin, near = _condensed(chi_squared, minimum)

    def is_reached(end: float | None) -> bool:
        """Return whether that profile has risen by ``threshold`` at an end."""
        if end is None:
            return True
        at = near.parameters | {parameter: end}
        try:
            profile = thin.minimise(at, (parameter,), rough=True).chi_squared
        except ConvergenceError:
            # A start this far from the minimum; the profile itself is followed in steps.
            return False
        return profile >= near.chi_squared + threshold

    value = minimum.parameters[parameter]
    inside = (ends[0] is None or ends[0] <= value) and (ends[1] is None or value <= ends[1])
    if inside and all(map(is_reached, ends)):
        return ends
    _, own = profiled(chi_squared, minimum, threshold, [parameter])
    return united(ends, own.get(parameter, OPEN))


def _condensed(chi_squared: ChiSquared, minimum: Minimum) -> tuple[ChiSquared, Minimum]:
    """Return a condensed χ² of which intervals are sought, if it is that smooth; its minimum."""
    thin = chi_squared.condensed(minimum.parameters, _FINE)
    if thin is chi_squared:
        return thin, minimum
    return thin, thin.minimise(minimum.parameters, rough=True)


def curvature_interval(
    parameter: Parameter, best: Minimum, bounds: Coordinates, threshold: float
) -> Ends:
    """Return the ends that the curvature of χ² gives; None for one beyond the limits."""
    value, width = best.parameters[parameter], float(np.sqrt(threshold)) * bounds[parameter]
    if not np.isfinite(width) or (parameter.logarithmic and width > _REACH):
        return None, None
    return value - width if value - width > parameter.minimum else None, value + width


def widen(
    ends: Mapping[Parameter, Ends], likelihood: ChiSquared, best: Minimum
) -> tuple[Mapping[Parameter, Ends], tuple[str, ...]]:
    """Return intervals widened by the change of the estimates on coarser grids, with a message."""
    coarse = likelihood.coarse()
    if coarse is None:
        return ends, ()
    other = coarse.minimise(best.parameters).parameters
    shift = {p: abs(other[p] - value) for p, value in best.parameters.items()}
    changes = [
        f"the {p.word} by "
        f"{decimal(100 * (np.expm1(shift[p]) if p.logarithmic else shift[p] / value), 2)} %"
        for p, value in best.parameters.items()
        if p in ends and p.shared and (p.logarithmic or value)
    ]
    message = (
        f"the force curve is simulated to {100 * likelihood.accuracy:.2g} %; half as many cells "
        f"change {' and '.join(changes)}, and the intervals are widened by these changes"
    )
    wider: dict[Parameter, Ends] = {}
    for p, (low, high) in ends.items():
        low = None if low is None or low - shift[p] <= p.minimum else low - shift[p]
        wider[p] = low, None if high is None else high + shift[p]
    return wider, (message,)


def confidence_interval(
    likelihood: ChiSquared, best: Minimum, parameter: Parameter, threshold: float
) -> Ends:
    """Return the ends at which the profile of χ² exceeds its minimum by ``threshold``.

    None stands for an end that is not reached: no tension, a modulus or a tension a hundred times
    as large or as small, or the limit of the contact point, of the baseline or of a thickness.

    Raises
    ------
    ImprovedMinimum
        The profile falls below ``best``.
    """
    value, (scale, low, high) = best.parameters[parameter], likelihood.ranges[parameter]
    if parameter.logarithmic and not parameter.is_length:
        low, high = value - _REACH, value + _REACH
    else:
        farthest = float(np.exp(_REACH)) * max(abs(value), scale)
        low, high = (
            limit if np.isfinite(limit) else sign * farthest
            for limit, sign in ((low, -1), (high, 1))
        )
    return (
        _end(likelihood, best, parameter, low, threshold),
        _end(likelihood, best, parameter, high, threshold),
    )


def _end(
    likelihood: ChiSquared, best: Minimum, parameter: Parameter, limit: float, threshold: float
) -> float | None:
    """Return where the profile has risen by ``threshold``; None if it has not at ``limit``."""
    value = best.parameters[parameter]
    span = limit - value
    if not span:
        return None
    path = {0.0: best.parameters}

    def excess(share: float) -> float:
        """Return √Δχ² − √threshold, which is nearly linear in the distance."""
        # Searches that start further away may end in another valley, so each starts from the last.
        inside = max(nearer for nearer in path if nearer <= share)
        start = path[inside]
        outside = min((known for known in path if known > share), default=None)
        # Rough searches end near their start, so it has to be a point of the path itself.
        if outside is not None and not likelihood.is_sudden:
            weight = (share - inside) / (outside - inside)
            start = {p: x + weight * (path[outside][p] - x) for p, x in start.items()}
        at = start | {parameter: value + share * span}
        minimum = likelihood.minimise(at, (parameter,), rough=likelihood.is_sudden)
        if minimum.chi_squared < best.chi_squared - _IMPROVEMENT:
            raise ImprovedMinimum(minimum)
        path[share] = minimum.parameters
        difference = max(minimum.chi_squared - best.chi_squared, 0.0)
        return float(np.sqrt(difference) - np.sqrt(threshold))

    deviation = likelihood.bounds(best.parameters, likelihood.free)[parameter]
    inside, below = 0.0, -float(np.sqrt(threshold))
    share = float(np.sqrt(threshold)) * deviation / abs(span)
    # On a cone without tension a small tension acts like a shift of the contact point, to first
    # order, so the linear estimate may lie beyond the limit.
    if share >= 1:
        share = _FIRST
    while (above := excess(share)) < 0:
        if share == 1:
            return None
        inside, below = share, above
        share = min(2 * share, 1.0)
    if above == 0:
        return value + share * span
    # brentq evaluates both ends again, whose values are known.
    values = {inside: below, share: above}
    root = brentq(
        lambda at: values[at] if at in values else excess(at),
        inside,
        share,
        xtol=_LEAST,
        rtol=_ACCURACY,
    )
    return value + float(root) * span
