"""Confidence intervals from the profile of χ²: where it has risen too far to be chance."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq
from scipy.special import stdtrit

from pellicle.arrays import Array

from .likelihood import MODULUS, REACH, TENSION, ChiSquared, Minimum

Ends = tuple[float | None, float | None]

CONFIDENCE = 0.95
_ACCURACY = 2e-3
"""To which an end is found, relative to its distance from the value."""
_FIRST = 1e-2
"""Share of the way to the limit that is tried first where the bound is beyond it."""
_LEAST = 1e-12
"""Share of the way to the limit that no end is nearer than."""
_BETTER = 1e-3
"""By this much less χ² a profile has found another minimum."""


class Better(Exception):  # noqa: N818 - no error: the search goes on from there
    """Raised by a profile that passes lower than the minimum it starts from."""

    def __init__(self, minimum: Minimum) -> None:
        super().__init__(minimum)
        self.minimum = minimum


def allowed_rise(freedom: float) -> float:
    """Return the rise of χ² at the ends of an interval, with the noise known that well."""
    return float(stdtrit(freedom, (1 + CONFIDENCE) / 2) ** 2)


def interval(likelihood: ChiSquared, best: Minimum, which: int, rise: float) -> Ends:
    """Return the ends between which the least χ² at a held parameter is up by at most ``rise``.

    None stands for an end that is not reached: tension 0, a modulus or a tension a hundred times
    off, or the limit of the contact point or of the baseline.

    Raises
    ------
    Better
        A profile passes below ``best``.
    """
    lowest, highest = _limits(likelihood, best.parameters, which)
    return (
        _end(likelihood, best, which, lowest, rise),
        _end(likelihood, best, which, highest, rise),
    )


def _limits(likelihood: ChiSquared, best: Array, which: int) -> tuple[float, float]:
    value, scale, kind = float(best[which]), float(likelihood.scale[which]), likelihood.kind(which)
    if kind == MODULUS:
        return value - REACH, value + REACH
    if kind == TENSION:
        return 0.0, float(np.exp(REACH)) * max(value, scale)
    lowest, highest = likelihood.limits
    return float(lowest[which]), float(highest[which])


def _end(
    likelihood: ChiSquared, best: Minimum, which: int, limit: float, rise: float
) -> float | None:
    value = float(best.parameters[which])
    span = limit - value
    if not span:
        return None
    # Minima on the way: a search that begins further out may end in another valley.
    path = {0.0: best.parameters}

    def excess(share: float) -> float:
        """Return √Δχ² − √rise, nearly linear in the distance."""
        start = path[max(nearer for nearer in path if nearer <= share)].copy()
        start[which] = value + share * span
        found = likelihood.minimise(start, (which,))
        if found.chi_squared < best.chi_squared - _BETTER:
            raise Better(found)
        path[share] = found.parameters
        return float(np.sqrt(max(found.chi_squared - best.chi_squared, 0.0)) - np.sqrt(rise))

    deviation = float(likelihood.bounds(best.parameters, likelihood.free)[which])
    inside, below = 0.0, -float(np.sqrt(rise))
    share = float(np.sqrt(rise)) * deviation / abs(span)
    # A cone without tension: a little of it has the effect of another contact point.
    if share >= 1:
        share = _FIRST
    while (above := excess(share)) < 0:
        if share == 1:
            return None
        inside, below = share, above
        share = min(2 * share, 1.0)
    if above == 0:
        return value + float(share) * span
    # brentq asks again for the ends that are known.
    known = {inside: below, share: above}
    root = brentq(
        lambda at: known[at] if at in known else excess(at),
        inside,
        share,
        xtol=_LEAST,
        rtol=_ACCURACY,
    )
    return value + float(root) * span
