"""Judge the equilibrium of a step in contact, and whether cells and theory hold it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from pellicle.analysis import steepest
from pellicle.arrays import Mask
from pellicle.config.run import Run
from pellicle.contact.caveats import Caveat, Status
from pellicle.contact.equilibrium import AdhesiveEquilibrium, Equilibrium
from pellicle.contact.masks import label_parts
from pellicle.grid import Boundary

from . import SMALL_SLOPE, AroundContact, ContactStep

# The force of a paraboloid is right to 8 % on nine or twelve cells, to 14 % on five, on fewer not.
_RESOLVED: Final = 13
_RESOLVED_ACROSS: Final = 4
# Slope beyond which a contact that does not stick is told.
_STEEPEST: Final = 1.0
# Relative change of G(q) q² over a decade below which it is the limit of short waves.
_CONSTANT: Final = 0.05


def contact(run: Run, step: ContactStep, around: AroundContact) -> ContactStep:
    """Add why the step is not a solution, or else what its cells and the theory do not hold."""
    if not np.isfinite(step.equilibrium.force):
        return step.with_measures({}, [Caveat(Status.NOT_FINITE)])
    step = step.with_measures({}, _failures(run, step, around))
    if not step.converged:
        return step
    return step.with_measures({}, [*_coarse(run, step.equilibrium), *_steep(run, step.equilibrium)])


def _failures(run: Run, step: ContactStep, around: AroundContact) -> Iterator[Caveat]:
    """Yield why the step is not a solution."""
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
                status, {"measure": residual, "tolerance": tolerance, "stop": step.stop.name}
            )
    contact, reach = equilibrium.contact, equilibrium.contact | equilibrium.zone
    size, boundary = run.grid.size, run.grid.boundary
    edges = {"size_x": size[0], "size_y": size[1]}
    if boundary == "free" and min(contact.shape) == 1 < contact.size and reach.any():
        yield Caveat(Status.STRIP, {"length": size[int(contact.shape[1] == 1)]})
    elif around.setting.footprint != "unbounded":
        return
    elif _has_no_end(contact, boundary):
        loading = run.indentation.loading
        prescribed: dict[str, float | str] = {
            "prescribed": loading.prescribed,
            "value": loading.values[len(around.path)],
            "unit": loading.prescription.unit,
        }
        yield Caveat(Status.CONTACT_AT_EDGE, edges | prescribed)
    elif _has_no_end(reach, boundary):
        yield Caveat(Status.ZONE_AT_EDGE, edges)
    elif boundary == "free" and not reach.any() and _is_pressed(equilibrium):
        heights = equilibrium.problem.heights
        if min(heights.shape) > 2 and heights[1:-1, 1:-1].max() < heights.max():
            yield Caveat(Status.BEYOND_EDGE, edges)


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
            if label_parts(twice, boundary, 8)[1] < 2 * label_parts(reach, boundary, 8)[1]:
                return True
    return False


def _coarse(run: Run, equilibrium: Equilibrium) -> Iterator[Caveat]:
    contact = equilibrium.contact
    # An interaction of a range of its own acts beyond the contact, however small that is.
    ranged = run.interaction is not None and run.interaction.cutoff() > 0
    cells = int(np.count_nonzero(contact | equilibrium.zone if ranged else contact))
    enough = _RESOLVED_ACROSS if min(contact.shape) == 1 else _RESOLVED
    # An interaction holds a contact at any depth.
    sticks = run.interaction is not None and bool(contact.any())
    if (_is_pressed(equilibrium) or sticks) and cells < min(enough, contact.size):
        yield Caveat(Status.COARSE, {"cells": cells, "width": run.grid.cell_size})


def _is_pressed(equilibrium: Equilibrium) -> bool:
    """Return whether what is prescribed asks for contact.

    A surface that was left behind may be out of the indenter's reach at a depth above 0.
    """
    problem = equilibrium.problem
    return problem.control.value > (problem.first_touch if problem.prescribed == "depth" else 0.0)


def _steep(run: Run, equilibrium: Equilibrium) -> Iterator[Caveat]:
    """Yield whether slopes are beyond the theory.

    With a surface tension τ₀, the limit of 1/(G q²) for short waves, the energy per area w that a
    law releases bends the surface at the rim by an angle √(2w/τ₀) (Young–Dupré at small slopes).
    Without one the slope of the theory has no bound, and depends on the range of the interaction.
    """
    contact, sticks = equilibrium.counted_contact, isinstance(equilibrium, AdhesiveEquilibrium)
    if not contact.any():
        return
    slope = steepest(equilibrium.problem.heights, contact, run.grid)
    if isinstance(equilibrium, AdhesiveEquilibrium):
        q = 1e3 * np.pi / min(run.grid.spacing) * np.array([1.0, 10.0])
        nothing = np.zeros_like(q)
        axes = [run.kernel.symbol(q, nothing), run.kernel.symbol(nothing, q)]
        a, b = np.maximum(*axes) * q**2
        if abs(b / a - 1) < _CONSTANT:
            slope = max(slope, float(np.sqrt(2 * equilibrium.problem.law.work_of_adhesion() * b)))
    # As it is told: an indenter of that very slope is not beyond it by rounding.
    if slope > SMALL_SLOPE if sticks else round(slope, 1) > _STEEPEST:
        yield Caveat(Status.STEEP, {"slope": slope, "most": SMALL_SLOPE})
