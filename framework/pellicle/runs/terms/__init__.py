"""Terms of a load step besides its equilibrium: each adds measures and caveats of its own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, TypeVar

from pellicle.components import Monitor, Setting
from pellicle.config.run import Run
from pellicle.contact.equilibrium import Deformation, Equilibrium
from pellicle.contact.load_step import FinishedStep, LoadStep

SMALL_SLOPE: Final = 0.3
"""Slope up to which the theory holds."""


@dataclass(frozen=True)
class Surroundings:
    """Data for a term besides the load step and the run."""

    path: Sequence[FinishedStep]
    """The steps before."""
    monitor: Monitor
    """Told of the iterations of a term that solves again."""


@dataclass(frozen=True)
class AroundContact(Surroundings):
    """The same of a step in contact."""

    setting: Setting
    """The setting of the step, with the displacement that earlier steps have left behind."""


AnyStep = LoadStep[Deformation]
ContactStep = LoadStep[Equilibrium]
Step = TypeVar("Step", AnyStep, ContactStep)
Term = Callable[[Run, ContactStep, AroundContact], ContactStep]
"""Returns the step with measures and caveats of its own added."""
