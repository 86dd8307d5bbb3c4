"""Intervals of the profile likelihood, with ends that a curve may leave open."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import stdtrit

from .objective import Minimum, Objective

CONFIDENCE = 0.95
_WIDE = 2.0
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
    """NaN if no value is within the intervals of all explanations that tie."""
    low: float | None
    """None if the curve determines no lower end (a tension may then be 0)."""
    high: float | None
    unit: str
    held: bool = False
    """Whether it was given, not fitted."""

    @property
    def is_narrow(self) -> bool:
        """Whether it was fitted, with ends of one sign and within a factor of 2.

        Of a wider interval the best value is one of many, and is not quoted.
        """
        if self.held or self.low is None or self.high is None or np.isnan(self.value):
            return False
        low, high = sorted((abs(self.low), abs(self.high)))
        return self.low * self.high > 0 and high <= _WIDE * low

    def to_dict(self) -> dict[str, Any]:
        """Return it as JSON data, in which a value that is not quoted is null."""
        return vars(self) | ({"value": None} if np.isnan(self.value) else {})

    @classmethod
    def of_dict(cls, data: Mapping[str, Any]) -> Estimate:
        """Return the estimate of which `to_dict` returned the data."""
        return cls(**{**data, "value": np.nan if data["value"] is None else data["value"]})


def common_value(estimates: Sequence[Estimate]) -> float:
    """Return the value that all estimates allow, at least half-widths from theirs; NaN if none is.

    An open end allows every value on its side.
    """

    def furthest(value: float) -> float:
        ends = ((e, e.high if value > e.value else e.low) for e in estimates)
        off = (
            0.0 if end is None else (value - e.value) / ((end - e.value) or np.inf)
            for e, end in ends
        )
        return max(off)

    values = [estimate.value for estimate in estimates]
    for one, other in permutations(estimates, 2):
        if one.high is not None and other.low is not None and one.value < other.value:
            up, down = one.high - one.value, other.value - other.low
            values.append((one.value * down + other.value * up) / ((up + down) or np.inf))
    value = min(values, key=furthest)
    return value if furthest(value) <= 1 else np.nan


class Better(Exception):  # noqa: N818 - not an error: the search continues from there
    """A profile has reached a smaller χ², its argument, than the minimum from which it starts."""


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
    left = _RESTARTS
    while True:
        # Where χ² jumps, every way may end a little lower.
        improvement, found = _IMPROVEMENT if left else np.inf, {}
        try:
            for k, slot in enumerate(objective.slots):
                if not names or slot.name in names:
                    estimate = _estimate(objective, minimum, k, threshold, improvement)
                    found[slot.full_name] = estimate
            return minimum, found
        except Better as better:
            minimum, left = objective.minimise(better.args[0].at), left - 1


def _estimate(
    objective: Objective, minimum: Minimum, k: int, threshold: float, improvement: float
) -> Estimate:
    """Return a quantity, with the ends at which χ² has risen by the threshold.

    If χ² is smaller on the way, by the improvement, that is raised.
    """
    at, slot = minimum.at, objective.slots[k]
    jacobian = objective.jacobian(at, range(at.size))
    others = [i for i in range(at.size) if i != k]
    # Along a profile the other coordinates move, to first order, as this makes χ² least.
    along = np.zeros(at.size)
    along[k] = 1.0
    if others:
        along[others] = -np.linalg.lstsq(jacobian[:, others], jacobian[:, k], rcond=1e-12)[0]
    # To first order an end lies here.
    first = threshold**0.5 / max(float(np.linalg.norm(jacobian @ along)), 1e-12)
    far = _REACH if slot.quantity.log else _FAR * max(abs(at[k]), 1.0)

    def excess(distance: float, sign: int, reached: dict[float, Minimum]) -> float:
        if distance not in reached:
            near = max(d for d in reached if d <= distance)
            start = reached[near].at + sign * (distance - near) * along
            start[k] = at[k] + sign * distance
            reached[distance] = objective.minimise(start, (k,))
        chi_squared = reached[distance].chi_squared
        if chi_squared < minimum.chi_squared - improvement:
            raise Better(reached[distance])
        return float(np.sqrt(max(chi_squared - minimum.chi_squared, 0)) - threshold**0.5)

    def end(sign: int) -> float | None:
        limit = min(abs(objective.limits[(sign + 1) // 2][k] - at[k]), far)
        distance, last, way = min(first, limit), 0.0, (sign, {0.0: minimum})
        while limit > 0 and np.isfinite(threshold):
            if excess(distance, *way) > 0:
                accuracy = _ACCURACY * distance
                distance = brentq(excess, last, distance, way, xtol=accuracy)
                return slot.value(at[k] + sign * distance)
            if distance >= limit:
                return None
            last, distance = distance, min(1.3 * distance, limit)
        return None

    return Estimate(slot.value(at[k]), end(-1), end(1), slot.quantity.unit)
