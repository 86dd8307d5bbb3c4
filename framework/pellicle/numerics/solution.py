"""What a solver returns for one load step."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from pellicle.arrays import Array


class Stop(Enum):
    """Why a solver stopped; the value is the remedy if the result is not good enough."""

    DONE = "tighten the solver's own criterion"
    ITERATION_LIMIT = "the limit of iterations was reached: raise solver.max_iterations"
    ROUND_OFF = "the tolerance is below round-off here: loosen solver.tolerance"
    STALLED = (
        "the solver makes no progress any more, and not because of round-off: try another solver, "
        "another load, or cells that resolve the heights"
    )
    NOT_FINITE = "the iteration met a value that is not finite"


@dataclass(frozen=True)
class Solution:
    """What a solver returns for one step."""

    pressure: Array
    """Contact pressure ≥ 0 [Pa], of the grid's shape."""
    iterations: int
    """Steps of the solver's outermost loop."""
    stop: Stop = Stop.DONE
    """Why it ended."""
