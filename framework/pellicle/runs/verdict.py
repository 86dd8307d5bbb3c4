"""Judge a solved load step by its measured residuals."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pellicle.analysis.steepness import rim_slope, steepest
from pellicle.config.run import Run
from pellicle.contact.caveats import Caveat, Status, ranked
from pellicle.contact.equilibrium import Equilibrium
from pellicle.contact.solution import Stop
from pellicle.contact.stiffness import Stiffness

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
) -> tuple[Caveat, ...]:
    """Return the caveats of a step, from its measured residuals, the gravest first.

    ``index`` counts from 0. ``lost`` is the energy [J] that the step lost because a part of the
    contact jumped, NaN if not known, None without a jump. ``largest_area`` [m²] is that of this
    step and those before.
    """
    caveats = [*_failures(run, index, step, stiffness), *_not_met(step)]
    if all(caveat.status.converged for caveat in caveats):
        caveats.extend(_limits(run, index, step.equilibrium, largest_area))
        if lost is not None:
            loss = "known" if lost > 0 else "unknown"
            caveats.append(Caveat(Status.JUMPED, {"lost": lost, "loss": loss}))
    return ranked(caveats)


def _failures(run: Run, index: int, step: Reached, stiffness: Stiffness | None) -> Iterator[Caveat]:
    """Yield why the step is not a solution."""
    equilibrium, tolerance = step.equilibrium, run.solver.tolerance
    if not np.isfinite(equilibrium.force):
        yield Caveat(Status.NOT_FINITE)
        return
    if step.stop is Stop.PULLED_OFF:
        carried, lost = step.between
        forces = {"force": equilibrium.problem.control.value, "carried": carried, "lost": lost}
        yield Caveat(Status.NOTHING_TO_PULL if carried == lost else Status.PULLED_OFF, forces)
        return
    if (lowest := float(equilibrium.wall.min())) < 0:
        share = -lowest / float(np.abs(equilibrium.wall).max())
        yield Caveat(Status.NEGATIVE_PRESSURE, {"measure": share})
    for status, residual in (
        (Status.LOAD, equilibrium.residual_load),
        (Status.CONTACT_RESIDUAL, equilibrium.residual_contact),
        (Status.PENETRATION, equilibrium.residual_penetration),
        (Status.COMPLEMENTARITY, equilibrium.residual_complementarity),
        (Status.TRACTION, equilibrium.residual_traction),
        (Status.STIFFNESS, stiffness.residual if stiffness else 0.0),
    ):
        if not residual <= tolerance:
            missed: dict[str, float | str] = {
                "measure": residual,
                "tolerance": tolerance,
                "stop": step.stop.name,
            }
            yield Caveat(status, missed)
    reach, loading = equilibrium.contact | equilibrium.zone, run.loading
    # A period one cell wide has no border in that direction: the problem is plane there.
    free = run.grid.boundary == "free"
    across = [axis for axis in (0, 1) if reach.shape[axis] > 1 or free]
    at_edge = any(np.take(reach, [0, -1], axis=axis).any() for axis in across)
    if run.indenter.footprint == "unbounded" and at_edge:
        yield Caveat(
            Status.CONTACT_AT_EDGE,
            {
                "size_x": run.grid.size[0],
                "size_y": run.grid.size[1],
                "prescribed": loading.prescribed,
                "value": loading.values[index],
                "unit": loading.prescription.unit,
            },
        )


def _limits(
    run: Run, index: int, equilibrium: Equilibrium, largest_area: float
) -> Iterator[Caveat]:
    """Yield what limits the accuracy of a solved step."""
    yield from _coarse(run, equilibrium)
    if run.interaction:
        cells, fewest = equilibrium.zone_width / run.grid.cell_size, run.interaction.least_cells
        if cells < fewest:
            yield Caveat(Status.COARSE_ZONE, {"cells": float(cells), "least": fewest})
        slope = steepest(equilibrium.problem.heights, equilibrium.contact, run.grid)
        if equilibrium.contact.any():
            slope = max(slope, rim_slope(run.kernel.compliance, equilibrium))
        if slope > _STEEPEST:
            yield Caveat(Status.STEEP, {"slope": slope, "most": _STEEPEST})
    needed, smallest = least_domain(run, index, largest_area), min(run.grid.size)
    if needed > smallest:
        yield Caveat(
            Status.SMALL_DOMAIN,
            {
                "size_x": run.grid.size[0],
                "size_y": run.grid.size[1],
                # Cells of another size may add a hundredth to the contact, and be refused in turn.
                "least_size": 1.02 * needed,
                "remedy": "larger domain" if needed <= _FARTHEST * smallest else "no domain",
            },
        )


def _coarse(run: Run, equilibrium: Equilibrium) -> Iterator[Caveat]:
    """Yield the caveat of a contact on too few cells."""
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
        yield Caveat(Status.COARSE, {"cells": cells, "width": run.grid.cell_size})


def _not_met(step: Reached) -> Iterator[Caveat]:
    """Yield the caveat of a search that ended away from its goal."""
    search = step.search
    if not search or (step.how == "met" and step.missed <= _NEAR):
        return
    values: dict[str, float | str] = {"quantity": search.quantity, "measure": step.missed}
    if step.how == "nearest":
        below, above = step.between
        values |= {"below": below, "above": above, "unit": search.unit}
    of_area = search.quantity == "contact area"
    if step.how == "nearest" and step.missed <= _NEAR:
        yield Caveat(Status.NEAREST_AREA if of_area else Status.NEAREST, values)
        return
    jump = "jump with a law" if step.equilibrium.problem.law else "jump"
    ends = {"met": "nothing nearer", "nearest": jump, "not found": "not found"}
    values |= {"tolerance": _NEAR, "end": ends[step.how]}
    yield Caveat(Status.AREA if of_area else Status.NOT_REACHED, values)
