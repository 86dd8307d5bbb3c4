"""What a load step has besides its equilibrium: each term adds measures and caveats of its own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from pellicle.components import Monitor, Setting
from pellicle.contact.load_step import FinishedStep, LoadStep


class Surroundings(NamedTuple):
    """What a term knows besides the load step and the run."""

    setting: Setting
    """That of the run, with what the steps before have left behind."""
    path: Sequence[FinishedStep]
    """The steps before."""
    monitor: Monitor
    """Told of the iterations of a term that solves again."""


Term = Callable[[LoadStep, Surroundings], LoadStep]
"""Returns the step with measures and caveats of its own added; the run is bound beforehand."""
