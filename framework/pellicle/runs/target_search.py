"""The load step at which a measured quantity has a prescribed value.

The contact area is a staircase function of the force, so the quantity may jump. The search ends at
any control whose value is within the resolution of the goal, or else at the jump across the goal,
located to a relative width, on the side nearer to the goal.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from pellicle.components import Depth, Force, Search, Setting
from pellicle.contact.caveats import Caveat, Status

from .terms import ContactStep

Solve = Callable[[Depth | Force], ContactStep]
"""Returns the load step at a depth or a force."""
# Number of trials to bracket the goal, after which it counts as out of reach.
_MOST_TRIALS: Final = 40
# Growth of log F over which a quantity that stays the same counts as one that does not grow.
_SATURATED: Final = math.log(1e6)
# Relative distance from its goal above which a search has not converged.
_NEAR: Final = 0.05


def search_target(setting: Setting, search: Search, solve: Solve, tolerance: float) -> ContactStep:
    """Return the load step at which the quantity of ``search`` has its goal.

    A bracket grows from the first trial; Brent's method (1973) then finds the root, in log F if the
    control is a force. ``solve`` starts every trial from the state of the step before; a
    relative error up to the ``tolerance`` is none.
    """
    from scipy.optimize import brentq

    trials = _Trials(setting, search, solve)
    low = high = trials.first()
    below = above = trials(low)
    while below > 0 and len(trials.excess) < _MOST_TRIALS:
        high, above = low, below
        low -= _stride(below, len(trials.excess))
        below = trials(low)
    while above < 0 and len(trials.excess) < _MOST_TRIALS and not trials.saturates(above):
        low, below = high, above
        high = min(high + _stride(above, len(trials.excess)), 0.5 * (high + trials.limit))
        above = trials(high)
    if above < 0 and trials.saturates(above):
        # The steps after this one would begin at a load beyond all measure.
        trials.repeat(above)
    if jumps := below < 0 < above:
        brentq(trials, low, high, xtol=search.width, rtol=1e-15)
    step = replace(trials.nearest, iterations=trials.iterations, missed=trials.missed)
    return step.with_measures({}, _not_met(trials, tolerance, jumps=jumps))


def _not_met(trials: _Trials, tolerance: float, *, jumps: bool) -> Iterator[Caveat]:
    """Yield the caveat of a search that ended away from its goal, across which it may jump."""
    search, is_near = trials.search, trials.missed <= _NEAR
    # Of a quantity that does not jump a search without a resolution finds values on either side.
    met = 0.0 in trials.excess.values() or trials.missed <= tolerance
    if met and is_near:
        return
    values: dict[str, float | str] = {"quantity": search.quantity, "measure": trials.missed}
    if jumps and not met:
        values |= {"below": trials.below, "above": trials.above, "unit": search.unit}
    if jumps and not met and is_near:
        yield Caveat(Status.NEAREST_AREA if search.in_cells else Status.NEAREST, values)
        return
    end = "not found"
    if met:
        end = "nothing nearer"
    elif jumps:
        end = "jump with a law" if trials.setting.sticks else "jump"
    values |= {"tolerance": _NEAR, "end": end}
    yield Caveat(Status.AREA if search.in_cells else Status.NOT_REACHED, values)


def _stride(excess: float, trials: int) -> float:
    """Return the step of log F towards the goal, which grows with every trial.

    The contact area grows at most as F^(2/3) under a smooth indenter, and as F under tension or if
    the indenter is rough.
    """
    return min(1.5 * abs(excess) + 0.02 * 2.0**trials, math.log(30.0))


@dataclass
class _Trials:
    """Solves for one control after the other, and keeps the step nearest to the goal."""

    setting: Setting
    search: Search
    solve: Solve
    excess: dict[float, float] = field(default_factory=dict)
    """Excess of the value over the goal by log F or by depth over `scale`, 0 if met.

    Of a quantity that falls as the control grows it is the negative, so that it grows too.
    """
    iterations: int = 0
    missed: float = math.inf
    below: float = -math.inf
    above: float = math.inf
    limit: float = math.inf
    """Depth of full contact over `scale`, which no load exceeds."""
    scale: float = field(init=False)
    nearest: ContactStep = field(init=False)

    def first(self) -> float:
        """Return the first control, scaled as in `excess`: the guess or that of the last step."""
        profile, state = self.setting.profile, self.setting.state
        heights = profile[np.isfinite(profile)]
        reach = 0.5 * float(np.ptp(heights)) or 1e-3 * min(self.setting.grid.spacing)
        guess = self.search.guess
        if self.search.control is Depth:
            self.scale = reach
            touch = -float(profile.max()) / reach
            if not self.setting.operator.has_mean_compliance:
                self.limit = -self.setting.mean_height / reach
            if guess is None and state is not None and self.setting.sticks:
                guess = state.depth
            depth = touch + 1.0 if guess is None else guess / reach
            return depth if depth < self.limit else 0.5 * (touch + self.limit)
        if guess is None and state is not None:
            guess = float(state.pressure.sum()) * self.setting.grid.cell_area
        if guess is None or guess <= 0:
            guess = self.setting.force_at(reach - float(profile.max()))
        return math.log(guess)

    def __call__(self, control: float) -> float:
        if control not in self.excess:
            force = self.search.control is not Depth
            self.excess[control] = self._try(math.exp(control) if force else control * self.scale)
        return self.excess[control]

    def saturates(self, excess: float) -> bool:
        """Return whether the force has grown by far without a change of the value."""
        same = [control for control, value in self.excess.items() if value == excess]
        return self.search.control is not Depth and max(same) - min(same) > _SATURATED

    def repeat(self, excess: float) -> None:
        """Solve again for the least control with a value, as the nearest step."""
        self._try(math.exp(min(c for c, value in self.excess.items() if value == excess)))

    def _try(self, control: float) -> float:
        goal = self.search.goal
        step = self.solve(self.search.control(control))
        self.iterations += step.iterations
        value = self.search.measure(step.equilibrium)
        missed = abs(value - goal) / (abs(goal) or 1.0)
        # Of two equal values the later is nearer to the jump.
        if missed <= self.missed:
            self.missed, self.nearest = missed, step
        if abs(value - goal) <= self.search.resolution:
            return 0.0
        if value < goal:
            self.below = max(self.below, value)
        else:
            self.above = min(self.above, value)
        direction = 1.0 if self.search.increasing else -1.0
        if goal and value / goal > 0:
            return direction * math.copysign(math.log(value / goal), value - goal)
        return direction * math.copysign(1.0, value - goal)
