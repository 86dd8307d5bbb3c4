"""Judge a solved load step by its measured residuals."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Mask
from pellicle.config.run import Run
from pellicle.numerics.problem import Equilibrium, Stiffness
from pellicle.results.status import Status
from pellicle.results.variables import VARIABLES

from .target_search import Reached

# A prescribed contact area that whole cells miss by more than this share is not what was asked.
_AREA_TOLERANCE = 0.05


# Of a paraboloid nine or twelve cells have the force to 8 %, five to 14 %, fewer do not have it.
_RESOLVED = 13


_RESOLVED_ACROSS = 4


def judge(
    run: Run, index: int, found: Equilibrium, step: Reached, stiffness: Stiffness | None
) -> tuple[Status, str]:
    """Return the status of a step by its measured residuals, and what the user is told."""
    tolerance = run.solver.tolerance
    if not np.isfinite(found.force):
        return Status.NOT_FINITE, Status.NOT_FINITE.value
    if (lowest := float(found.pressure.min())) < 0:
        share = -lowest / float(found.pressure.max())
        return Status.NEGATIVE_PRESSURE, Status.NEGATIVE_PRESSURE.value.format(measure=share)
    for status, residual in (
        (Status.LOAD, found.residual_load),
        (Status.CONTACT_RESIDUAL, found.residual_contact),
        (Status.PENETRATION, found.residual_penetration),
        (Status.COMPLEMENTARITY, found.residual_complementarity),
        (Status.STIFFNESS, stiffness.residual if stiffness else 0.0),
    ):
        if not residual <= tolerance:
            return status, status.value.format(
                measure=residual, tolerance=tolerance, remedy=step.solution.stop.value
            )
    if run.indenter.footprint == "unbounded" and _touches_edge(run, found.contact):
        nx, ny = run.grid.size
        value, name = run.loading.values[index], run.loading.prescribed
        return Status.CONTACT_AT_EDGE, Status.CONTACT_AT_EDGE.value.format(
            size=f"{nx:g} × {ny:g} m",
            prescribed=f"loading.{name} = {value:g} {VARIABLES[name].unit}",
        )
    if step.how == "not found" or step.missed > _AREA_TOLERANCE:
        remedy = "use more points" if step.how == "nearest" else "no load was found that brings it"
        return Status.AREA, Status.AREA.value.format(
            measure=step.missed, tolerance=_AREA_TOLERANCE, remedy=remedy
        )
    if step.how == "nearest":
        return Status.NEAREST_AREA, Status.NEAREST_AREA.value.format(measure=step.missed)
    cells = int(np.count_nonzero(found.contact))
    enough = _RESOLVED_ACROSS if min(found.contact.shape) == 1 else _RESOLVED
    if step.problem.control.value > 0 and cells < min(enough, found.contact.size):
        return Status.COARSE, Status.COARSE.value.format(cells=cells or "none")
    return Status.CONVERGED, Status.CONVERGED.value


def _touches_edge(run: Run, contact: Mask) -> bool:
    """Whether a cell at the border is in contact.

    A period one cell wide has no border across: there the problem is plane.
    """
    plane = run.grid.boundary == "periodic"
    across = [axis for axis in (0, 1) if contact.shape[axis] > 1 or not plane]
    return any(np.take(contact, [0, -1], axis=axis).any() for axis in across)
