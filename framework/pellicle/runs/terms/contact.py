"""Judge the equilibrium of a load step, and whether the cells resolve its contact."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pellicle.arrays import Mask
from pellicle.config.run import Run
from pellicle.contact.caveats import Caveat, Status
from pellicle.contact.equilibrium import Equilibrium
from pellicle.contact.masks import labelled
from pellicle.grid import Boundary

from . import ContactStep, Surroundings

# The force of a paraboloid is right to 8 % on nine or twelve cells, to 14 % on five, on fewer not.
_RESOLVED = 13
_RESOLVED_ACROSS = 4


def contact(run: Run, step: ContactStep, surroundings: Surroundings) -> ContactStep:
    """Add why the step is not a solution, and whether its contact has too few cells."""
    if not np.isfinite(step.equilibrium.force):
        return step.having({}, [Caveat(Status.NOT_FINITE)])
    value = run.indentation.loading.values[len(surroundings.path)]
    step = step.having({}, _failures(run, step, value))
    return step.having({}, _coarse(run, step.equilibrium)) if step.converged else step


def _failures(run: Run, step: ContactStep, value: float) -> Iterator[Caveat]:
    """Yield why the step is not a solution; ``value`` is the prescribed one."""
    equilibrium, tolerance = step.equilibrium, run.solver.tolerance
    if (lowest := float(equilibrium.wall.min())) < 0:
        share = -lowest / float(np.abs(equilibrium.wall).max())
        yield Caveat(Status.NEGATIVE_PRESSURE, {"measure": share})
    for status, residual in (
        (Status.LOAD, equilibrium.residual_load),
        (Status.CONTACT_RESIDUAL, equilibrium.residual_contact),
        (Status.PENETRATION, equilibrium.residual_penetration),
        (Status.COMPLEMENTARITY, equilibrium.residual_complementarity),
        (Status.TRACTION, equilibrium.residual_traction),
    ):
        if not residual <= tolerance:
            yield Caveat(
                status,
                {"measure": residual, "tolerance": tolerance, "stop": step.stop.name},
            )
    contact, reach = equilibrium.contact, equilibrium.contact | equilibrium.zone
    size, boundary, (indenter, loading) = run.grid.size, run.grid.boundary, run.indentation
    edges = {"size_x": size[0], "size_y": size[1]}
    if boundary == "free" and min(contact.shape) == 1 < contact.size and reach.any():
        yield Caveat(Status.STRIP, {"length": size[int(contact.shape[1] == 1)]})
    elif indenter.footprint != "unbounded":
        return
    elif _has_no_end(contact, boundary):
        yield Caveat(
            Status.CONTACT_AT_EDGE,
            {
                **edges,
                "prescribed": loading.prescribed,
                "value": value,
                "unit": loading.prescription.unit,
            },
        )
    elif _has_no_end(reach, boundary):
        yield Caveat(Status.ZONE_AT_EDGE, edges)


def _has_no_end(reach: Mask, boundary: Boundary) -> bool:
    """Return whether cells reach the edge of a free domain, or their own image on a periodic one.

    A patch that goes on into its image is one patch in two periods side by side. A period one cell
    wide has no border in that direction: the problem is plane there.
    """
    for axis in (0, 1):
        if boundary == "free":
            if np.take(reach, [0, -1], axis=axis).any():
                return True
        elif reach.shape[axis] > 1 and reach.any(axis=1 - axis).all():
            twice = np.concatenate([reach, reach], axis)
            if labelled(twice, boundary, 8)[1] < 2 * labelled(reach, boundary, 8)[1]:
                return True
    return False


def _coarse(run: Run, equilibrium: Equilibrium) -> Iterator[Caveat]:
    contact, problem = equilibrium.contact, equilibrium.problem
    # An interaction of a range of its own acts beyond the contact, however small that is.
    ranged = run.interaction is not None and run.interaction.cutoff() > 0
    cells = int(np.count_nonzero(contact | equilibrium.zone if ranged else contact))
    enough = _RESOLVED_ACROSS if min(contact.shape) == 1 else _RESOLVED
    # A surface that was left behind may be out of the indenter's reach at a depth above 0.
    least = problem.first_touch if problem.prescribed == "depth" else 0.0
    # An interaction holds a contact at any depth.
    sticks = run.interaction is not None and bool(contact.any())
    if (problem.control.value > least or sticks) and cells < min(enough, contact.size):
        yield Caveat(Status.COARSE, {"cells": cells, "width": run.grid.cell_size})
