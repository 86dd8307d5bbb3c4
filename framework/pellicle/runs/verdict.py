"""Judge a solved load step by its measured residuals."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Mask
from pellicle.components.prescription import Search, in_unit
from pellicle.config.run import Run
from pellicle.numerics.problem import Stiffness
from pellicle.results.status import Status

from .target_search import Reached

# A search that ends further from its goal than this share has not converged.
_NEAR = 0.05
# With nine or twelve cells a paraboloid has its force to 8 %, with five to 14 %, with fewer not.
_RESOLVED = 13
_RESOLVED_ACROSS = 4


def judge(run: Run, value: float, step: Reached, stiffness: Stiffness | None) -> tuple[Status, str]:
    """Return the status of a step by its measured residuals, and the message to the user."""
    found = step.equilibrium
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
                measure=residual, tolerance=tolerance, remedy=step.stop.value
            )
    if run.indenter.footprint == "unbounded" and _touches_edge(run, found.contact):
        nx, ny = run.grid.size
        loading = run.loading
        return Status.CONTACT_AT_EDGE, Status.CONTACT_AT_EDGE.value.format(
            size=f"{nx:g} × {ny:g} m",
            prescribed=f"loading.{loading.prescribed} = "
            f"{in_unit(value, loading.prescription.unit)}",
        )
    if step.search and (step.how != "met" or step.missed > _NEAR):
        return _not_met(step, step.search)
    cells = int(np.count_nonzero(found.contact))
    enough = _RESOLVED_ACROSS if min(found.contact.shape) == 1 else _RESOLVED
    if found.problem.control.value > 0 and cells < min(enough, found.contact.size):
        return Status.COARSE, Status.COARSE.value.format(cells=cells or "none")
    return Status.CONVERGED, Status.CONVERGED.value


def _not_met(step: Reached, search: Search) -> tuple[Status, str]:
    """Return the status of a search that ended away from its goal."""
    near, far = Status.NEAREST, Status.NOT_REACHED
    if search.quantity == "contact area":
        near, far = Status.NEAREST_AREA, Status.AREA
    # What falls as the control grows is measured by its negative.
    below, above = sorted(map(abs, step.between))
    words = {
        "quantity": search.quantity,
        "measure": step.missed,
        "tolerance": _NEAR,
        "below": in_unit(below, search.unit),
        "above": in_unit(above, search.unit),
    }
    if step.how == "nearest" and step.missed <= _NEAR:
        return near, near.value.format(**words)
    remedy = "no load was found that brings it"
    if step.how == "nearest":
        remedy = "it jumps from {below} to {above}: use more points".format(**words)
    return far, far.value.format(**words, remedy=remedy)


def _touches_edge(run: Run, contact: Mask) -> bool:
    """Whether a cell at the border is in contact.

    A period one cell wide has no border across: there the problem is plane.
    """
    plane = run.grid.boundary == "periodic"
    across = [axis for axis in (0, 1) if contact.shape[axis] > 1 or not plane]
    return any(np.take(contact, [0, -1], axis=axis).any() for axis in across)
