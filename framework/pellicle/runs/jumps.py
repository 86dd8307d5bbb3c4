"""Jumps of an adhesive contact on its path: patches that come or go, and energy that is lost."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from pellicle.contact.equilibrium import Equilibrium
from pellicle.contact.labels import labelled
from pellicle.contact.solution import State
from pellicle.contact.start import PathPoint

# Share of |ΔF Δδ|/2 by which the trapezoidal rule may miss the work of a step without a jump. It
# is 1/3 for F ∝ √(δ − δ₀), the steepest that a force falls before it jumps.
_MISSED: Final = 0.5
# Share of |F Δδ| that does not count as a jump: the change of the energy with the place of the edge
# on the cells, 0.005 at two cells in the zone.
_UNCERTAIN: Final = 0.01


def asperity_jumped(before: State | None, equilibrium: Equilibrium) -> bool:
    """Return whether a whole patch of contact and zone has come or gone since the state ``before``.

    Without a range of its own, adhesion holds a contact down to a finite radius, at which it jumps
    off (Johnson, Kendall & Roberts 1971), and a contact that begins jumps to a finite radius. A law
    of a real range may let go gradually, so it counts as no jump there.
    """
    problem = equilibrium.problem
    if before is None or not problem.law or not problem.law.needs_contact:
        return False
    patches = before.pressure != 0, equilibrium.pressure != 0
    for mask, other in (patches, patches[::-1]):
        labels, number = labelled(mask, problem.grid.boundary, 4)
        if np.unique(labels[mask & other]).size < number:
            return True
    return False


def jump_energy(path: Sequence[PathPoint], equilibrium: Equilibrium, tolerance: float) -> float:
    """Return the energy [J] that jumps have lost since the end of a path; 0 if too little to tell.

    ``path`` has the last two steps, or fewer, solved to the residual ``tolerance``.

    Without a jump the energy changes by the work ∫F dδ of the step, whatever is prescribed; a jump
    loses the rest. That counts if it is more than the trapezoidal rule may miss, so every jump
    shows once the steps are small enough. NaN where the energy is not known, or the last step did
    not converge.
    """
    if not path:
        return float("nan")
    lost, uncertain = _lost_energy(path, equilibrium, tolerance)
    return 0.0 if lost <= uncertain else lost


def _lost_energy(
    path: Sequence[PathPoint], equilibrium: Equilibrium, tolerance: float
) -> tuple[float, float]:
    """Return the energy [J] lost since the end of a path, and by how much it is uncertain.

    The trapezoidal rule misses a share of |ΔF Δδ|/2 where F is monotonic. Across an extremum, where
    ΔF may be 0, it misses one of |B Δδ|/2, B being the departure of F from the slope of the step
    before: F″Δδ³/12 for a constant F″, which is 1/3 at most. Energies are known to the tolerance of
    their elastic and adhesive parts, which may cancel.
    """
    problem, last = equilibrium.problem, path[-1]
    assert problem.law
    cell = problem.grid.cell_area
    forces = [*(float(point.state.pressure.sum()) * cell for point in path), equilibrium.force]
    steps = np.diff([*(point.state.depth for point in path), equilibrium.depth])
    acting = np.count_nonzero(equilibrium.pressure) * cell
    parts = max(abs(last.energy), abs(equilibrium.energy))
    parts += 2 * acting * problem.law.work_of_adhesion()
    step, greatest = float(steps[-1]), max(map(abs, forces[-2:]))
    lost = last.energy - equilibrium.energy + 0.5 * (forces[-2] + forces[-1]) * step
    varies = abs(forces[-1] - forces[-2])
    if len(path) == 2 and steps[0]:
        bend = forces[-1] - forces[-2] - (forces[1] - forces[0]) / steps[0] * step
        # The slope of a step that was almost held is that of its errors.
        varies = max(varies, min(abs(bend), greatest))
    share = 0.5 * _MISSED * varies + _UNCERTAIN * greatest
    return lost, share * abs(step) + tolerance * parts
