"""The time of a load step, and what a solid that relaxes makes of its accuracy."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from pellicle.config.run import Run
from pellicle.contact.caveats import Caveat, Status
from pellicle.contact.equilibrium import Deformation, Equilibrium
from pellicle.contact.load_step import FinishedStep, Value
from pellicle.contact.time_step import stiffness_after
from pellicle.runs.relaxation import CarriedShare
from pellicle.surface import along_axes

from . import Step, Surroundings

# Domain that a solid needs, over that of the run, above which no grid spans it.
_FARTHEST: Final = 100.0
# Softest solid, over its instantaneous stiffness, and longest wave, over a third of the domain,
# that are told from a liquid.
_SOFTEST: Final = 1e-9
_LONGEST: Final = 1e9
# 8 radii of a contact, to each of which its counted cells may add a hundredth.
_RADII: Final = 7.9


def relaxation(run: Run, step: Step, surroundings: Surroundings) -> Step:
    """Add the time and cycle of the step, and whether the domain is small."""
    loading, index = run.loading, len(surroundings.path)
    measures: dict[str, Value] = {}
    if loading.times:
        measures["time"] = loading.times[index]
    if loading.oscillates:
        measures["cycle"] = loading.samples[index].cycle
    if run.interaction and run.branches and loading.durations[index] > 0:
        # The energy of a solid that has relaxed on its way does not follow from its surface.
        measures["energy"] = np.nan
    largest_area = _largest_area(run, step.equilibrium, surroundings.path)
    needed, smallest = _least_domain(run, index, largest_area), min(run.grid.size)
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


def _largest_area(run: Run, surface: Deformation, path: Sequence[FinishedStep]) -> float:
    """Return the largest contact area so far [m²], or that of a disc that holds all of a load."""
    if isinstance(surface, Equilibrium):
        area = np.count_nonzero(surface.counted_contact) * run.grid.cell_area
        return max(area, *(finished.area for finished in path), 0.0)
    loaded = surface.pressure != 0
    for finished in path:
        loaded |= finished.state.pressure != 0
    distance = np.hypot(*run.grid.coordinates())
    return math.pi * float(distance.max(where=loaded, initial=0.0)) ** 2


def _least_domain(run: Run, index: int, largest_area: float) -> float:
    """Return the edge [m] that a domain needs at a step, for what its solid carries outside.

    It is 8 radii of the largest contact so far, since a solid remembers a contact that has shrunk,
    or 7.9 of those that the cells of ``largest_area`` [m²] count; and 3 times the length 1/q of the
    wave for which the skin is as stiff as the solid is after the duration of the run so far: 2τ₀/E*
    under a tension. It is 0 where there is nothing outside: at the first step, without a skin, and
    on a periodic boundary.
    """
    kernel, branches = run.kernel, run.branches
    if not index or not branches or run.grid.boundary == "periodic":
        return 0.0
    solid = kernel.without_skin()
    if solid == kernel:
        return 0.0
    elapsed = math.fsum(run.loading.durations[: index + 1])
    share = max(_SOFTEST, stiffness_after(branches, elapsed))
    carried = CarriedShare(kernel.scaled(share), solid)
    shortest = 3 / min(run.grid.size)
    radius = math.sqrt(largest_area / math.pi)
    length = 0.0
    if share * along_axes(carried.symbol, np.array([shortest])).item() < 0.5:
        waves = shortest * np.geomspace(1 / _LONGEST, 1.0, 1 + 20 * round(math.log10(_LONGEST)))
        stiff = np.flatnonzero(share * along_axes(carried.symbol, waves) >= 0.5)
        length = 1 / float(waves[stiff[-1]]) if stiff.size else math.inf
    return max(_RADII * radius, 3 * length)
