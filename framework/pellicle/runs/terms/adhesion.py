"""Numbers of an adhesive step besides its solution: limit of the force, greatest pull, jumps."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from pellicle.analysis.steepness import rim_slope, steepest
from pellicle.components import Force
from pellicle.components.interaction import law_of
from pellicle.config.run import Run
from pellicle.contact.caveats import Caveat, Status
from pellicle.contact.equilibrium import Equilibrium
from pellicle.contact.load_step import LoadStep, Value
from pellicle.contact.problem import Depth
from pellicle.contact.solution import Stop
from pellicle.runs.jumps import asperity_jumped, jump_energy

from .surroundings import Solve, Surroundings

# Widths of two zones over that of the step, for the limit of no width.
_WIDER: Final = (1.5, 3.0)
# Weight of the force of the step beside those of wider zones, in which the place of the edge on the
# cells changes forces by half as much.
_WEIGHT: Final = 0.5
# Relative error of a pulled contact's force, times the cells in its radius: the largest of
# paraboloids at pull-off with 3 to 12 cells, at s/a₀ = 0, 0.3 and 3.
_CELLS_ERROR: Final = 0.55
# Halvings of the interval of forces in which the contact is lost.
_HALVINGS: Final = 6
# Slope beyond which the theory of small slopes does not hold.
_STEEPEST: Final = 0.3


def adhesion(run: Run, step: LoadStep, surroundings: Surroundings) -> LoadStep:
    """Add jumps, the limit of the force, and whether zone and slopes are those of the theory."""
    setting, equilibrium, jumped_as_whole = surroundings.setting, step.equilibrium, step.jumped
    if step.effort.stop is Stop.PULLED_OFF:
        step = step.having({}, [_pulled_off(step, surroundings)])
    lost = jump_energy(setting.path, equilibrium, run.solver.tolerance)
    jumped = jumped_as_whole or lost > 0 or asperity_jumped(setting.state, equilibrium)
    limit = _force_limit(run, equilibrium, surroundings.solve)
    step = step.having({"jumped": jumped, "jump_energy": lost, **limit})
    if not step.converged:
        return step
    caveats = [*_limits(run, equilibrium)]
    if jumped and not jumped_as_whole and equilibrium.contact.any():
        loss = "known" if lost > 0 else "unknown"
        caveats.append(Caveat(Status.JUMPED, {"lost": lost, "loss": loss}))
    return step.having({}, caveats)


def _limits(run: Run, equilibrium: Equilibrium) -> Iterator[Caveat]:
    """Yield whether the zone has too few cells, and whether slopes are beyond the theory."""
    assert run.interaction
    cells, fewest = equilibrium.zone_width / run.grid.cell_size, run.interaction.least_cells
    if cells < fewest:
        yield Caveat(Status.COARSE_ZONE, {"cells": cells, "least": fewest})
    slope = steepest(equilibrium.problem.heights, equilibrium.contact, run.grid)
    if equilibrium.contact.any():
        slope = max(slope, rim_slope(run.kernel.compliance, equilibrium))
    if slope > _STEEPEST:
        yield Caveat(Status.STEEP, {"slope": slope, "most": _STEEPEST})


def _force_limit(run: Run, equilibrium: Equilibrium, solve: Solve) -> dict[str, Value]:
    """Return the force [N] for no width of the zone, and the error [N] of that of the step.

    The step is solved again at its depth with two wider zones. The forces differ from that of no
    zone in proportion to its width, so a line through all three gives the limit (Richardson 1911).
    The error is the larger of those that the two narrower and the two wider zones give: they differ
    because the edge lies on cells, and because the widest may reach over half of a small contact.
    The widest zones of a contact of few cells say too little, so it is at least a share of a pull.
    Both are NaN if the contact is lost or no solution is found with a wider zone; the result is
    empty if the interaction has no such limit.
    """
    sticky = run.interaction
    wider_laws = [law for factor in _WIDER if (law := sticky.wider(factor))] if sticky else []
    if not sticky or not wider_laws:
        return {}
    if not equilibrium.contact.any():
        return {"force_extrapolated": equilibrium.force, "force_error": 0.0}
    forces = [equilibrium.force]
    wider = equilibrium
    for resolved in wider_laws:
        problem = replace(
            equilibrium.problem,
            law=law_of(sticky, run.kernel, run.grid, resolved),
            control=Depth(equilibrium.depth),
        )
        _, wider = solve(problem, wider.state)
        if not (wider.contact.any() and wider.residual <= run.solver.tolerance):
            return {"force_extrapolated": np.nan, "force_error": np.nan}
        forces.append(wider.force)
    widths = np.array([1.0, *_WIDER])
    weights = np.where(widths > 1, 1.0, _WEIGHT)
    _, limit = np.polyfit(widths, forces, 1, w=weights)
    slopes = np.diff(forces) / np.diff(widths)
    limits = forces[:-1] - slopes * widths[:-1]
    cells = np.sqrt(np.count_nonzero(equilibrium.contact) / np.pi)
    least = _CELLS_ERROR / cells * max(-equilibrium.force, 0.0)
    error = max(least, float(np.abs(limits - equilibrium.force).max()))
    return {"force_extrapolated": float(limit), "force_error": error}


def _pulled_off(step: LoadStep, surroundings: Surroundings) -> Caveat:
    """Return the caveat with two forces [N], of which the contact of the last state carries one."""
    setting, force = surroundings.setting, step.equilibrium.problem.control.value
    state = setting.state
    if state is None or not state.contact.any():
        return Caveat(Status.NOTHING_TO_PULL, {"force": force})
    carried, lost = float(state.pressure.sum()) * setting.grid.cell_area, force
    for _ in range(_HALVINGS):
        middle = 0.5 * (carried + lost)
        solution, _ = surroundings.solve(setting.problem(Force(middle)), state)
        if solution.stop is Stop.PULLED_OFF:
            lost = middle
        else:
            carried = middle
    return Caveat(Status.PULLED_OFF, {"force": force, "carried": carried, "lost": lost})
