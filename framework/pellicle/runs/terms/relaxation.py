"""The time of a load step, and what a solid that relaxes leaves unknown."""

from __future__ import annotations

import numpy as np

from pellicle.config.run import Run
from pellicle.contact.load_step import Value

from . import Step, Surroundings


def relaxation(run: Run, step: Step, surroundings: Surroundings) -> Step:
    """Add the time and cycle of the step."""
    loading, index = run.loading, len(surroundings.path)
    measures: dict[str, Value] = {}
    if loading.times:
        measures["time"] = loading.times[index]
    if loading.oscillates:
        measures["cycle"] = loading.samples[index].cycle
    if run.interaction and run.branches and loading.durations[index] > 0:
        # The energy of a solid that has relaxed on its way does not follow from its surface.
        measures["energy"] = np.nan
    return step.with_measures(measures)
