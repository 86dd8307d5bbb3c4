"""Intervals of the profile likelihood, with ends that a curve may leave open."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from itertools import permutations
from typing import Any

import numpy as np
from scipy.special import stdtrit

from pellicle.arrays import Array

from .objective import Objective
from .search import Minimum, descend

CONFIDENCE = 0.95
_WIDE = 2.0
_REACH = np.log(100.0)
"""Change of a logarithm up to which an end is sought."""
_FAR = 100.0
"""Change of another coordinate likewise, over its value or its size."""
_NEAR, _SMALL, _STEPS = 0.02, 0.1, 40
"""Last step over the distance, and last excess over the rise, whose squares are the error of an
end; and most steps."""
_PROFILE = 5e-3
"""Fall of χ² that is left on a profile, small beside the threshold."""
_IMPROVEMENT = 1e-2
"""Decrease of χ² by which another minimum counts as better."""
_RESTARTS = 5
_ALIKE = 1e-5
"""Least singular value of derivatives of unit length that are not alike."""


class End(Enum):
    """What an end of an interval is."""

    CLOSED = "closed"
    LIMIT = "reaches the limit of the quantity"
    RANGE = "sought up to a factor of 100"
    STEPS = "not found"
    LACKING = "what lacks it describes the data as well"
    ANOTHER = "beside what describes the data it is not that of the solid"
    NOT_SOUGHT = "not sought"


_ENDS = {end.name.lower(): end for end in End}


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
    ends: tuple[End, End] = (End.NOT_SOUGHT, End.NOT_SOUGHT)
    """What the lower and the upper end are."""

    @property
    def is_narrow(self) -> bool:
        """Whether it was fitted, with ends of one sign and within a factor of 2.

        Of a wider interval the best value is one of many, and is not quoted.
        """
        if self.held or self.low is None or self.high is None or np.isnan(self.value):
            return False
        low, high = sorted((abs(self.low), abs(self.high)))
        return self.low * self.high > 0 and high <= _WIDE * low

    def times(self, factor: float) -> Estimate:
        """Return the estimate of a multiple, by a factor > 0."""
        low, high = (end and end * factor for end in (self.low, self.high))
        return replace(self, value=self.value * factor, low=low, high=high)

    def to_dict(self) -> dict[str, Any]:
        """Return it as JSON data, in which a value that is not quoted is null."""
        value = None if np.isnan(self.value) else self.value
        return vars(self) | {"value": value, "ends": [end.name.lower() for end in self.ends]}

    @classmethod
    def of_dict(cls, data: Mapping[str, Any]) -> Estimate:
        """Return the estimate of which `to_dict` returned the data."""
        value = np.nan if data["value"] is None else data["value"]
        known = {**data, "value": value}
        if "ends" in data:
            known["ends"] = tuple(_ENDS[name] for name in data["ends"])
        return cls(**known)


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
    for lower, upper in permutations(estimates, 2):
        if lower.high is not None and upper.low is not None and lower.value < upper.value:
            up, down = lower.high - lower.value, upper.value - upper.low
            values.append((lower.value * down + upper.value * up) / ((up + down) or np.inf))
    value = min(values, key=furthest)
    return value if furthest(value) <= 1 else np.nan


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
    numbers = [k for k, slot in enumerate(objective.slots) if not names or slot.name in names]
    for left in range(_RESTARTS, -1, -1):
        jacobian = objective.jacobian(minimum.at, range(minimum.at.size))
        pairs = [(k, sign) for k in numbers for sign in (-1, 1)]
        ways = [_Way(objective, minimum, jacobian, *pair, threshold) for pair in pairs]
        # Where χ² jumps, every way may end a little lower.
        better = _followed(objective, minimum, ways, _IMPROVEMENT if left else np.inf)
        if better is None:
            break
        minimum = objective.minimise(better.at)
    intervals = {}
    for k, low, high in zip(numbers, ways[::2], ways[1::2], strict=True):
        slot = objective.slots[k]
        value = slot.value(minimum.at[k])
        unit, ends = slot.quantity.unit, (low.kind, high.kind)
        intervals[slot.full_name] = Estimate(value, low.end, high.end, unit, ends=ends)
    return minimum, intervals


class _Way:
    """The way from a minimum to one end of an interval, on which a coordinate is held."""

    def __init__(
        self,
        objective: Objective,
        minimum: Minimum,
        jacobian: Array,
        k: int,
        sign: int,
        threshold: float,
    ) -> None:
        at, self.slot = minimum.at, objective.slots[k]
        self.minimum, self.k, self.sign, self.rise = minimum, k, sign, threshold**0.5
        others = [i for i in range(at.size) if i != k]
        # Along a profile the other coordinates move, to first order, as this makes χ² least.
        self.along = np.zeros(at.size)
        self.along[k] = 1.0
        if others:
            # What another coordinate does as well is left out.
            sizes = np.maximum(np.linalg.norm(jacobian[:, others], axis=0), 1e-300)
            scaled = jacobian[:, others] / sizes
            least = np.linalg.lstsq(scaled, jacobian[:, k], rcond=_ALIKE)[0]
            self.along[others] = -least / sizes
        # To first order an end lies here.
        first = self.rise / max(float(np.linalg.norm(jacobian @ self.along)), 1e-12)
        far = _REACH if self.slot.quantity.log else _FAR * max(abs(at[k]), 1.0)
        to_limit = abs(objective.limits[(sign + 1) // 2][k] - at[k])
        self.limit = min(to_limit, far)
        self.distance = min(first, self.limit)
        self.below, self.above = (0.0, -self.rise, at), (np.inf, 0.0, at)
        self.before = self.below
        self.is_done = not (self.limit > 0 and np.isfinite(threshold))
        self.end: float | None = None
        self._open = End.LIMIT if to_limit <= far else End.RANGE
        self._is_sought = bool(np.isfinite(threshold))

    @property
    def start(self) -> Array:
        """Coordinates from which the next point of the profile is sought."""
        near, _, at = self.below if self.above[0] > self.distance else self.above
        along, (first, _, known) = self.sign * self.along, self.before
        if near > first:
            # The way so far says more than its direction at the minimum.
            along = (at - known) / (near - first)
        start = at + (self.distance - near) * along
        start[self.k] = self.minimum.at[self.k] + self.sign * self.distance
        return np.asarray(start)

    def advance(self, minimum: Minimum) -> None:
        """Go on from the least χ² at the present distance, by a secant of the root of its rise."""
        rise = float(np.sqrt(max(minimum.chi_squared - self.minimum.chi_squared, 0.0)))
        here, excess, last = self.distance, rise - self.rise, self.below
        if excess > 0:
            self.above = here, excess, minimum.at
        else:
            self.before, self.below = last, (here, excess, minimum.at)
            if here >= self.limit:
                self.is_done = True
                return
        bracketed = np.isfinite(self.above[0])
        first, second = (self.below, self.above) if bracketed else (last, self.below)
        if second[0] <= first[0]:
            # χ² jumps here: from another start a search has found another minimum.
            self.stop()
            self.is_done = True
            return
        slope = (second[1] - first[1]) / (second[0] - first[0])
        new = first[0] - first[1] / slope if slope > 0 else np.inf
        is_close = abs(excess) <= _SMALL * self.rise
        if bracketed:
            low, high = self.below[0], self.above[0]
            # A secant that creeps along a wall is halved.
            margin = 0.1 * (high - low)
            if not is_close and not low + margin < new < high - margin:
                new = (low + high) / 2
        else:
            new = min(new, 1.5 * here, self.limit)
        self.distance = new
        if is_close and abs(new - here) <= _NEAR * here and new <= self.limit:
            self.is_done = True
            if new < self.limit or excess > 0:
                self.end = self._value

    @property
    def _value(self) -> float:
        """The quantity at the present distance, in SI."""
        return self.slot.value(self.minimum.at[self.k] + self.sign * self.distance)

    @property
    def kind(self) -> End:
        """What the end is that was reached."""
        if not self._is_sought:
            return End.NOT_SOUGHT
        return End.CLOSED if self.end is not None else self._open

    def stop(self) -> None:
        """Take what brackets an end for it, where χ² jumps."""
        if not self.is_done and np.isfinite(self.above[0]):
            self.distance = self.above[0]
            self.end = self._value
        elif not self.is_done:
            self._open = End.STEPS


def _followed(
    objective: Objective, minimum: Minimum, ways: Sequence[_Way], improvement: float
) -> Minimum | None:
    """Follow all ways to their ends; return a lower minimum than theirs if one meets it."""
    for _ in range(_STEPS):
        going = [way for way in ways if not way.is_done]
        if not going:
            return None
        held = np.zeros((len(going), minimum.at.size), dtype=bool)
        held[np.arange(len(going)), [way.k for way in going]] = True
        minima = descend(objective, np.array([way.start for way in going]), held, fall=_PROFILE)
        for way, least in zip(going, minima, strict=True):
            if least.chi_squared < minimum.chi_squared - improvement:
                return least
            way.advance(least)
    for way in ways:
        way.stop()
    return None
