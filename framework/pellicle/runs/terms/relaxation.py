"""The time of a load step, and what a solid that relaxes makes of its accuracy."""

from __future__ import annotations

from typing import Final

import numpy as np

from pellicle.components.kernel import branches_of
from pellicle.config.run import Run
from pellicle.contact.caveats import Caveat, Status
from pellicle.contact.load_step import LoadStep, Value
from pellicle.runs.relaxation_checks import least_domain

from .surroundings import Surroundings

# Domain that a solid needs, over that of the run, above which no grid spans it.
_FARTHEST: Final = 100.0


def relaxation(run: Run, step: LoadStep, surroundings: Surroundings) -> LoadStep:
    """Add the time and cycle of the step, and whether the domain is small."""
    loading, index = run.loading, len(surroundings.path)
    measures: dict[str, Value] = {}
    if loading.times:
        measures["time"] = loading.times[index]
    if loading.oscillates:
        measures["cycle"] = loading.samples[index].cycle
    if surroundings.setting.law and branches_of(run.kernel) and loading.durations[index] > 0:
        # The energy of a solid that has relaxed on its way does not follow from its surface.
        measures["energy"] = np.nan
    area = np.count_nonzero(step.equilibrium.contact) * run.grid.cell_area
    largest_area = max(area, *(finished.area for finished in surroundings.path), 0.0)
    needed, smallest = least_domain(run, index, largest_area), min(run.grid.size)
    if needed <= smallest or not step.converged:
        return step.having(measures)
    values: dict[str, float | str] = {
        "size_x": run.grid.size[0],
        "size_y": run.grid.size[1],
        # Cells of another size may add a hundredth to the contact, and be refused in turn.
        "least_size": 1.02 * needed,
        "remedy": "larger domain" if needed <= _FARTHEST * smallest else "no domain",
    }
    return step.having(measures, [Caveat(Status.SMALL_DOMAIN, values)])
