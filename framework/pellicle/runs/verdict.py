"""Judge a solved load step by its measured residuals."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pellicle.analysis.steepness import rim_slope, steepest
from pellicle.components.prescription import Search
from pellicle.config.run import Run
from pellicle.contact.equilibrium import Equilibrium
from pellicle.contact.solution import Stop
from pellicle.contact.stiffness import Stiffness
from pellicle.results.status import Status, with_caveats
from pellicle.units import DIGITS, readable

from .relaxation_checks import least_domain
from .target_search import Reached

# Relative distance from its goal above which a search has not converged.
_NEAR = 0.05
# The force of a paraboloid is right to 8 % on nine or twelve cells, to 14 % on five, on fewer not.
_RESOLVED = 13
_RESOLVED_ACROSS = 4
# Slope beyond which the theory of small slopes does not hold.
_STEEPEST = 0.3

# Domain that a solid needs, over that of the run, above which no grid spans it.
_FARTHEST = 100.0


def judge(
    run: Run,
    index: int,
    step: Reached,
    stiffness: Stiffness | None,
    lost: float | None,
    largest_area: float,
) -> tuple[Status, str]:
    """Return the status of a step, from its measured residuals, and the message to the user.

    The status is that of the most important caveat; the message has them all. ``index`` counts from
    0. ``lost`` is the energy [J] that the step lost because a part of the contact jumped, 0 if not
    known, None without a jump. ``largest_area`` [m²] is that of this step and those before.
    """
    verdicts = [verdict] if (verdict := _failure(run, index, step, stiffness)) else []
    if not verdicts and step.search and (step.how != "met" or step.missed > _NEAR):
        verdicts.append(_not_met(step, step.search))
    if all(status.converged for status, _ in verdicts):
        verdicts.extend(_caveats(run, index, step.equilibrium, largest_area))
        if lost is not None:
            loss = f" and lost {readable(lost, 'J', DIGITS)}" if lost > 0 else ""
            verdicts.append((Status.JUMPED, Status.JUMPED.value.format(loss=loss)))
    if not verdicts:
        return Status.CONVERGED, Status.CONVERGED.value
    return verdicts[0][0], with_caveats([message for _, message in verdicts])


def _failure(
    run: Run, index: int, step: Reached, stiffness: Stiffness | None
) -> tuple[Status, str] | None:
    """Return why the step is not a solution; None if it is one."""
    equilibrium = step.equilibrium
    if not np.isfinite(equilibrium.force):
        return Status.NOT_FINITE, Status.NOT_FINITE.value
    if step.stop is Stop.PULLED_OFF:
        carried, lost = step.between
        status = Status.NOTHING_TO_PULL if carried == lost else Status.PULLED_OFF
        return status, status.value.format(
            force=readable(equilibrium.problem.control.value, "N", DIGITS),
            carried=readable(carried, "N", DIGITS),
            lost=readable(lost, "N", DIGITS),
        )
    if (lowest := float(equilibrium.wall.min())) < 0:
        share = -lowest / float(np.abs(equilibrium.wall).max())
        return Status.NEGATIVE_PRESSURE, Status.NEGATIVE_PRESSURE.value.format(measure=share)
    tolerance = run.solver.tolerance
    for status, residual in (
        (Status.LOAD, equilibrium.residual_load),
        (Status.CONTACT_RESIDUAL, equilibrium.residual_contact),
        (Status.PENETRATION, equilibrium.residual_penetration),
        (Status.COMPLEMENTARITY, equilibrium.residual_complementarity),
        (Status.TRACTION, equilibrium.residual_traction),
        (Status.STIFFNESS, stiffness.residual if stiffness else 0.0),
    ):
        if not residual <= tolerance:
            return status, status.value.format(
                measure=residual, tolerance=tolerance, remedy=step.stop.value
            )
    reach, loading = equilibrium.contact | equilibrium.zone, run.loading
    # A period one cell wide has no border in that direction: the problem is plane there.
    free = run.grid.boundary == "free"
    across = [axis for axis in (0, 1) if reach.shape[axis] > 1 or free]
    at_edge = any(np.take(reach, [0, -1], axis=axis).any() for axis in across)
    if run.indenter.footprint == "unbounded" and at_edge:
        return Status.CONTACT_AT_EDGE, Status.CONTACT_AT_EDGE.value.format(
            size=" × ".join(readable(edge, "m", DIGITS) for edge in run.grid.size),
            prescribed=f"loading.{loading.prescribed} = "
            f"{readable(loading.values[index], loading.prescription.unit, DIGITS)}",
        )
    return None


def _caveats(
    run: Run, index: int, equilibrium: Equilibrium, largest_area: float
) -> Iterator[tuple[Status, str]]:
    """Yield what limits the accuracy of a solved step."""
    if coarse := _coarse(run, equilibrium):
        yield coarse
    if run.interaction:
        cells, fewest = equilibrium.zone_width / run.grid.cell_size, run.interaction.least_cells
        # A contact on too few cells has too few in its zone, too.
        if cells < fewest and not coarse:
            message = Status.COARSE_ZONE.value.format(cells=cells, least=fewest)
            yield Status.COARSE_ZONE, message
        slope = steepest(equilibrium.problem.heights, equilibrium.contact, run.grid)
        if equilibrium.contact.any():
            slope = max(slope, rim_slope(run.kernel.compliance, equilibrium))
        if slope > _STEEPEST:
            yield Status.STEEP, Status.STEEP.value.format(slope=slope, most=_STEEPEST)
    needed = least_domain(run, index, largest_area)
    if needed > min(run.grid.size):
        # Cells of another size may add a hundredth to the contact, and be refused in turn.
        least = readable(1.02 * needed, "m", DIGITS)
        if needed <= _FARTHEST * min(run.grid.size):
            remedy = (
                f"use grid.size ≥ {least}: 8 contact radii, and 3 times the length 2τ₀/E* below "
                "which the skin is stiffer than the relaxed solid"
            )
        else:
            remedy = (
                f"no grid spans the {least} that a solid so soft would need: its depth depends on "
                "where the domain ends, its force at a given contact hardly"
            )
        size = " × ".join(readable(length, "m", DIGITS) for length in run.grid.size)
        yield Status.SMALL_DOMAIN, Status.SMALL_DOMAIN.value.format(size=size, remedy=remedy)


def _coarse(run: Run, equilibrium: Equilibrium) -> tuple[Status, str] | None:
    """Return the caveat of a contact on too few cells; None if it has enough."""
    contact, problem = equilibrium.contact, equilibrium.problem
    # An interaction of a range of its own acts beyond the contact, however small that is.
    ranged = run.interaction is not None and not run.interaction.needs_contact
    cells = int(np.count_nonzero(contact | equilibrium.zone if ranged else contact))
    enough = _RESOLVED_ACROSS if min(contact.shape) == 1 else _RESOLVED
    # A surface that was left behind may be out of the indenter's reach at a depth above 0.
    least = problem.first_touch if problem.prescribed == "depth" else 0.0
    # An interaction holds a contact at any depth.
    sticks = run.interaction is not None and bool(contact.any())
    if (problem.control.value > least or sticks) and cells < min(enough, contact.size):
        return Status.COARSE, Status.COARSE.value.format(
            cells=cells or "none", width=readable(run.grid.cell_size, "m", DIGITS)
        )
    return None


def _not_met(step: Reached, search: Search) -> tuple[Status, str]:
    """Return the status of a search that ended away from its goal."""
    near, far = Status.NEAREST, Status.NOT_REACHED
    if search.quantity == "contact area":
        near, far = Status.NEAREST_AREA, Status.AREA
    below, above = step.between
    words = {
        "quantity": search.quantity,
        "measure": step.missed,
        "tolerance": _NEAR,
        "below": readable(below, search.unit, DIGITS),
        "above": readable(above, search.unit, DIGITS),
    }
    if step.how == "nearest" and step.missed <= _NEAR:
        return near, near.value.format(**words)
    finer = "use more points"
    if step.equilibrium.problem.law:
        finer = "no contact between them is stable, or the cells are too large to show it"
    remedy = {
        "met": "nothing nearer can be resolved: use more points",
        "nearest": "it jumps from {below} to {above}: {finer}".format(**words, finer=finer),
        "not found": "no load that attains it was found",
    }[step.how]
    return far, far.value.format(**words, remedy=remedy)
