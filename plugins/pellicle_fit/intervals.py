"""Intervals of the profile likelihood, with ends that a curve may leave open."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import stdtrit

from pellicle.arrays import Array

from .objective import Minimum, Objective

CONFIDENCE = 0.95
_REACH = np.log(100.0)
"""Change of a logarithm up to which an end is sought."""
_FAR = 100.0
"""Change of another coordinate likewise, over its value or its size."""
_ACCURACY = 2e-3
"""Accuracy of an end over its distance from the best value."""
_IMPROVEMENT = 1e-3
"""Decrease of χ² by which another minimum counts as better."""
_RESTARTS = 5


@dataclass(frozen=True)
class Estimate:
    """A quantity of a fit: its value in SI and the ends of its 95 % interval."""

    value: float
    low: float | None
    """None if the curve determines no lower end (a tension may then be 0)."""
    high: float | None
    unit: str
    held: bool = False
    """Whether it was given, not fitted."""


class Better(Exception):  # noqa: N818 - not an error: the search continues from there
    """A profile has reached a smaller χ² than the minimum from which it starts."""

    def __init__(self, minimum: Minimum) -> None:
        super().__init__(minimum)
        self.minimum = minimum


def threshold_of(freedom: float) -> float:
    """Return Δχ² at the ends of an interval, for noise of that many degrees of freedom.

    It is the square of Student's t: 3.84 if the noise is known exactly.
    """
    return float(stdtrit(freedom, (1 + CONFIDENCE) / 2) ** 2)


def estimates(
    objective: Objective, minimum: Minimum, threshold: float, names: Sequence[str] = ()
) -> tuple[Minimum, dict[str, Estimate]]:
    """Return the estimates of some quantities, or of all, and the minimum, which may improve.

    A quantity of one of several curves has the number of the curve behind its name.
    """

    def found(improvement: float) -> dict[str, Estimate]:
        return {
            slot.name if not slot.curve else f"{slot.name}_{slot.curve}": _estimate(
                objective, minimum, k, threshold, improvement
            )
            for k, slot in enumerate(objective.slots)
            if not names or slot.name in names
        }

    for _ in range(_RESTARTS):
        try:
            return minimum, found(_IMPROVEMENT)
        except Better as better:
            minimum = objective.minimise(better.minimum.at)
    # Where χ² jumps, every way may end a little lower.
    return minimum, found(np.inf)


def _estimate(
    objective: Objective, minimum: Minimum, k: int, threshold: float, improvement: float
) -> Estimate:
    """Return a quantity, with the ends at which χ² has risen by the threshold.

    Raises
    ------
    Better
        χ² is smaller on the way, by the improvement.
    """
    jacobian = objective.jacobian(minimum.at, range(minimum.at.size))
    others = [i for i in range(minimum.at.size) if i != k]
    # Along a profile the other coordinates move, to first order, as this makes χ² least.
    along = np.zeros(minimum.at.size)
    along[k] = 1.0
    if others:
        along[others] = -np.linalg.lstsq(jacobian[:, others], jacobian[:, k], rcond=1e-12)[0]
    rise = float(np.linalg.norm(jacobian @ along))
    slot = objective.slots[k]
    low, high = (
        _end(objective, minimum, k, threshold, sign, along, rise, improvement) for sign in (-1, 1)
    )
    return Estimate(
        slot.value(minimum.at[k]),
        None if low is None else slot.value(low),
        None if high is None else slot.value(high),
        slot.quantity.unit,
    )


def _end(
    objective: Objective,
    minimum: Minimum,
    k: int,
    threshold: float,
    sign: int,
    along: Array,
    rise: float,
    improvement: float,
) -> float | None:
    """Return one end of an interval."""
    if not np.isfinite(threshold):
        return None
    best, slot = minimum.at[k], objective.slots[k]
    wall = abs(objective.limits[(sign + 1) // 2][k] - best)
    far = _REACH if slot.quantity.log else _FAR * max(abs(best), 1.0)
    limit = min(wall, far)
    reached = {0.0: minimum}

    def excess(distance: float) -> float:
        if distance not in reached:
            near = max(d for d in reached if d <= distance)
            start = reached[near].at + sign * (distance - near) * along
            start[k] = best + sign * distance
            reached[distance] = objective.minimise(start, (k,))
        chi_squared = reached[distance].chi_squared
        if chi_squared < minimum.chi_squared - improvement:
            raise Better(reached[distance])
        return float(np.sqrt(max(chi_squared - minimum.chi_squared, 0)) - threshold**0.5)

    # To first order the end lies here.
    distance, last = min(threshold**0.5 / max(rise, 1e-12), limit), 0.0
    while limit > 0:
        if excess(distance) > 0:
            accuracy = _ACCURACY * distance
            return float(best + sign * brentq(excess, last, distance, xtol=accuracy))
        if distance >= limit:
            return None
        last, distance = distance, min(1.3 * distance, limit)
    return None
