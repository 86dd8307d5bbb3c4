"""Terms of a load step besides its equilibrium: each adds measures and caveats of its own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeVar

from pellicle.components import Monitor, Setting
from pellicle.contact.equilibrium import Deformation, Equilibrium
from pellicle.contact.load_step import FinishedStep, LoadStep


class Surroundings(NamedTuple):
    """Data for a term besides the load step and the run."""

    setting: Setting
    """The setting of the run, with the displacement that earlier steps have left behind."""
    path: Sequence[FinishedStep]
    """The steps before."""
    monitor: Monitor
    """Told of the iterations of a term that solves again."""


AnyStep = LoadStep[Deformation]
ContactStep = LoadStep[Equilibrium]
Step = TypeVar("Step", AnyStep, ContactStep)
Term = Callable[[ContactStep, Surroundings], ContactStep]
"""Returns the step with measures and caveats of its own added; the run is bound beforehand."""
