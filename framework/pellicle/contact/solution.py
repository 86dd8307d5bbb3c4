"""The initial state and the solution of a solver."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple, Self

import numpy as np

from pellicle.arrays import Array, Mask


class State(NamedTuple):
    """The surface at the end of a load step, from which the next step starts."""

    pressure: Array
    """Traction p = w + σ(g) on the surface [Pa], of the grid's shape."""
    wall: Array
    """Wall pressure w ≥ 0 [Pa]; equals `pressure` if no traction acts across the gap."""
    depth: float
    """Depth δ of the indenter [m]."""

    @classmethod
    def of_pressure(cls, pressure: Array) -> Self:
        """Return the state of a ``pressure`` ≥ 0 [Pa] where no traction acts across the gap.

        The depth follows from the pressure, so that a solver need not compute it.
        """
        return cls(pressure, pressure, np.nan)

    @property
    def contact(self) -> Mask:
        """The cells on which the indenter presses, w > 0; bool of the grid's shape."""
        return self.wall > 0

    @property
    def is_loaded(self) -> bool:
        """Whether the indenter presses or a traction acts anywhere."""
        return bool(self.wall.any() or self.pressure.any())


class Stop(Enum):
    """The reason why a solver stopped; the value is the remedy if the tolerance is not met."""

    DONE = "tighten the solver's own criterion"
    ITERATION_LIMIT = "the limit of iterations was reached: raise solver.max_iterations"
    ROUND_OFF = "the tolerance is below round-off here: loosen solver.tolerance"
    STALLED = (
        "the solver makes no progress any more, and not because of round-off: try another solver, "
        "another load, or cells that resolve the heights"
    )
    PULLED_OFF = "no contact carries this pull"
    NOT_FINITE = "the iteration met a value that is not finite"


@dataclass(frozen=True)
class Solution:
    """The solution of one load step."""

    state: State
    iterations: int
    """Steps of the solver's outermost loop."""
    stop: Stop = Stop.DONE
    """Why the solver stopped."""
    jumped: bool = False
    """Whether all contact was gained or lost in a jump since the start; only with a law."""

    @property
    def pressure(self) -> Array:
        """The pressure [Pa], of the grid's shape."""
        return self.state.pressure


class Progress(NamedTuple):
    """Number of iterations without progress, judged by measures that fall during progress."""

    least: tuple[float, ...] = ()
    """The least value of each measure so far."""
    stagnant: int = 0
    """Iterations since one of them fell below its least value."""

    def after(self, *measures: float) -> Progress:
        """Return the progress after one more iteration with these measures."""
        if not self.least:
            return Progress(measures)
        pairs = tuple(zip(measures, self.least, strict=True))
        improved = any(measure < least for measure, least in pairs)
        return Progress(tuple(map(min, pairs)), 0 if improved else self.stagnant + 1)
