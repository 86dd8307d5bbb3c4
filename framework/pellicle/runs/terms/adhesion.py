"""Numbers of an adhesive step besides its solution: limit of the force, greatest pull, jumps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from pellicle.components import Force, Interaction, Monitor
from pellicle.components.calls import solution_of
from pellicle.components.interaction import law_of
from pellicle.config.run import Run
from pellicle.contact.caveats import Caveat, Status
from pellicle.contact.equilibrium import AdhesiveEquilibrium, equilibrium_of
from pellicle.contact.load_step import Value, control_of
from pellicle.contact.masks import label_parts
from pellicle.contact.problem import Depth
from pellicle.contact.solution import State, Stop

from . import AroundContact, ContactStep

# Widths of two zones over that of the step, for the limit of no width.
_WIDER: Final = (1.5, 3.0)
# Least tolerance of both: it moves the limit by 6e-6 of its value, and by 5e-4 of its error.
_LOOSE: Final = 1e-6
# Weight of the force of the step beside those of wider zones, in which the place of the edge on the
# cells changes forces by half as much.
_WEIGHT: Final = 0.5
# Relative error of a pulled contact's force, times the cells in its radius: the largest of
# paraboloids at pull-off with 3 to 12 cells, at s/a₀ = 0, 0.3 and 3.
_CELLS_ERROR: Final = 0.55
# Halvings of the interval of forces in which the contact is lost.
_HALVINGS: Final = 6
# Share of |ΔF Δδ|/2 by which the trapezoidal rule may miss the work of a step without a jump. It
# is 1/3 for F ∝ √(δ − δ₀), the steepest that a force falls before it jumps.
_MISSED: Final = 0.5
# Halvings of a step that seems to jump, and the share of its loss that is left in one part of it if
# it does: what the rule misses falls at least as the step to 3/2, to 0.04.
_REFINEMENTS: Final = 4
_STAYS: Final = 0.25
# Share of |F Δδ| that does not count as a jump: the change of the energy with the place of the edge
# on the cells, 0.005 at two cells in the zone.
_UNCERTAIN: Final = 0.01


def adhesion(run: Run, step: ContactStep, surroundings: AroundContact) -> ContactStep:
    """Add jumps, the limit of the force, and whether its zone has few cells, where it sticks."""
    setting, equilibrium, interaction = surroundings.setting, step.equilibrium, run.interaction
    if not isinstance(equilibrium, AdhesiveEquilibrium) or interaction is None:
        return step
    if step.stop is Stop.PULLED_OFF:
        step = step.with_measures({}, [_pulled_off(run, step, surroundings)])
    touched = setting.state is not None and bool(setting.state.contact.any())
    as_whole = bool(equilibrium.contact.any()) != touched
    jumped = step.jumped or _asperity_jumped(setting.state, equilibrium)
    lost = _jump_energy(run, equilibrium, surroundings, is_certain=jumped, as_whole=as_whole)
    jumped = jumped or lost > 0
    limit = _force_limit(run, interaction, equilibrium, surroundings.monitor)
    step = step.with_measures({"jumped": jumped, "jump_energy": lost, **limit})
    if not step.converged:
        return step
    caveats, cells = [], equilibrium.zone_width / run.grid.cell_size
    if cells < (fewest := interaction.least_cells):
        caveats.append(Caveat(Status.COARSE_ZONE, {"cells": cells, "least": fewest}))
    if jumped and not as_whole and equilibrium.contact.any():
        loss = "known" if lost > 0 else "unknown"
        caveats.append(Caveat(Status.JUMPED, {"lost": lost, "loss": loss}))
    return step.with_measures({}, caveats)


def _force_limit(
    run: Run, sticky: Interaction, equilibrium: AdhesiveEquilibrium, monitor: Monitor
) -> dict[str, Value]:
    """Return the force [N] for no width of the zone, and the error [N] of that of the step.

    The step is solved again at its depth with two wider zones, for `limit_of` the three forces. The
    widest zones of a contact of few cells say too little, so the error is at least a share of a
    pull.
    Both are NaN if the contact is lost or no solution is found with a wider zone; the result is
    empty if the interaction has no such limit.
    """
    wider_laws = [law for factor in _WIDER if (law := sticky.wider(factor))]
    if not wider_laws:
        return {}
    if not equilibrium.contact.any():
        return {"force_extrapolated": equilibrium.force, "force_error": 0.0}
    forces = [equilibrium.force]
    wider = equilibrium
    solver = run.solver.model_copy(update={"tolerance": max(_LOOSE, run.solver.tolerance)})
    for resolved in wider_laws:
        problem = replace(
            equilibrium.problem,
            law=law_of(sticky, run.kernel, run.grid, resolved),
            control=Depth(equilibrium.depth),
        )
        wider = equilibrium_of(problem, solution_of(solver, problem, wider.state, monitor))
        if not (wider.contact.any() and wider.residual <= solver.tolerance):
            return {"force_extrapolated": np.nan, "force_error": np.nan}
        forces.append(wider.force)
    limit, error = limit_of(forces)
    cells = np.sqrt(np.count_nonzero(equilibrium.contact) / np.pi)
    least = _CELLS_ERROR / cells * max(-equilibrium.force, 0.0)
    return {"force_extrapolated": limit, "force_error": max(least, error)}


def limit_of(forces: Sequence[float]) -> tuple[float, float]:
    """Return the force [N] for no width of the zone, and the error [N] of that of the step.

    The forces are those of zones 1, 1.5 and 3 times as wide as in the step. They differ from that
    of no zone in proportion to its width, so a line through all three gives the limit (Richardson
    1911). The error is the larger of those that the two narrower and the two wider zones give: they
    differ because the edge lies on cells, and because the widest may reach over half of a small
    contact.
    """
    widths = np.array([1.0, *_WIDER])
    weights = np.where(widths > 1, 1.0, _WEIGHT)
    _, limit = np.polyfit(widths, forces, 1, w=weights)
    slopes = np.diff(forces) / np.diff(widths)
    limits = forces[:-1] - slopes * widths[:-1]
    return float(limit), float(np.abs(limits - forces[0]).max())


def _pulled_off(run: Run, step: ContactStep, surroundings: AroundContact) -> Caveat:
    """Return the caveat with two forces [N], of which the contact of the last state carries one."""
    setting, force = surroundings.setting, step.equilibrium.problem.control.value
    state = setting.state
    if state is None or not state.contact.any():
        return Caveat(Status.NOTHING_TO_PULL, {"force": force})
    carried, lost = float(state.pressure.sum()) * setting.grid.cell_area, force
    for _ in range(_HALVINGS):
        middle = 0.5 * (carried + lost)
        problem = setting.problem(Force(middle))
        if solution_of(run.solver, problem, state, surroundings.monitor).stop is Stop.PULLED_OFF:
            lost = middle
        else:
            carried = middle
    return Caveat(Status.PULLED_OFF, {"force": force, "carried": carried, "lost": lost})


def _asperity_jumped(before: State | None, equilibrium: AdhesiveEquilibrium) -> bool:
    """Return whether a whole patch of contact and zone has come or gone since the state ``before``.

    Without a range of its own, adhesion holds a contact down to a finite radius, at which it jumps
    off (Johnson, Kendall & Roberts 1971), and a contact that begins jumps to a finite radius. A law
    of a real range may let go gradually, so it counts as no jump there.
    """
    problem = equilibrium.problem
    if before is None or not problem.law.needs_contact:
        return False
    patches = before.pressure != 0, equilibrium.pressure != 0
    for mask, counterpart in (patches, patches[::-1]):
        labels, number = label_parts(mask, problem.grid.boundary, 4)
        if np.unique(labels[mask & counterpart]).size < number:
            return True
    return False


class _Point(NamedTuple):
    """A state on the path, and what the work between it and another one is computed from."""

    state: State
    depth: float
    force: float
    energy: float

    def loss(self, after: _Point) -> float:
        """Return the work up to another point less the change of the energy [J]."""
        return (
            self.energy
            - after.energy
            + 0.5 * (self.force + after.force) * (after.depth - self.depth)
        )

    def missed(self, after: _Point) -> float:
        """Return how much of it [J] the trapezoidal rule may leave without a jump."""
        return 0.5 * _MISSED * abs((after.force - self.force) * (after.depth - self.depth))


def _jump_energy(
    run: Run,
    equilibrium: AdhesiveEquilibrium,
    surroundings: AroundContact,
    *,
    is_certain: bool,
    as_whole: bool,
) -> float:
    """Return the energy [J] that jumps have lost since the end of a path; 0 if too little to tell.

    Without a jump the energy changes by the work ∫F dδ of the step, whatever is prescribed; a jump
    loses the rest. That counts if it is more than the trapezoidal rule may miss, so every jump
    shows once the steps are small enough. Unless it ``is_certain``, the step is halved where most
    is missing: what a bend of the force misses falls with the step, and is no jump; what a jump
    loses stays. Where contact begins or ends as a whole it is halved there, unless the loss of a
    certain jump shows already, and the loss is that of the last part. Energies are known to the
    tolerance of their elastic and adhesive parts, which may cancel.

    NaN where the energy is not known, or the last step did not converge.
    """
    path, problem, tolerance = surroundings.setting.path, equilibrium.problem, run.solver.tolerance
    if not path:
        return float("nan")
    last = path[-1]
    cell = problem.grid.cell_area
    acting = np.count_nonzero(equilibrium.pressure) * cell
    parts = max(abs(last.energy), abs(equilibrium.energy))
    force = float(last.state.pressure.sum()) * cell
    pair = _Point(last.state, last.state.depth, force, last.energy), _point_of(equilibrium)
    lost = pair[0].loss(pair[1])
    greatest = max(abs(point.force) for point in pair)
    noise = tolerance * (parts + 2 * acting * problem.law.work_of_adhesion())
    noise += _UNCERTAIN * greatest * abs(pair[1].depth - pair[0].depth)

    def excess(pair: tuple[_Point, _Point]) -> float:
        return pair[0].loss(pair[1]) - pair[0].missed(pair[1]) - noise

    is_hidden = excess(pair) <= 0
    if is_hidden and not as_whole:
        return 0.0
    ends = control_of(problem, last.state), problem.value
    halvings = 0 if is_certain and not is_hidden else _REFINEMENTS * (1 + is_certain)
    for _ in range(0 if np.isnan(lost) else halvings):
        middle = 0.5 * (ends[0] + ends[1])
        halved = replace(problem, control=replace(problem.control, value=middle))
        solution = solution_of(run.solver, halved, pair[0].state, surroundings.monitor)
        between = equilibrium_of(halved, solution)
        if solution.stop is Stop.PULLED_OFF or not between.residual <= tolerance:
            break
        point = _point_of(between)
        halves = (pair[0], point), (point, pair[1])
        later = point.state.contact.any() == pair[0].state.contact.any()
        worse = int(later if as_whole else excess(halves[1]) > excess(halves[0]))
        pair, ends = halves[worse], ((ends[0], middle), (middle, ends[1]))[worse]
        if not as_whole and (excess(pair) <= 0 or pair[0].loss(pair[1]) < _STAYS * lost):
            return 0.0
    if excess(pair) <= 0:
        return 0.0
    return pair[0].loss(pair[1]) if as_whole else lost


def _point_of(equilibrium: AdhesiveEquilibrium) -> _Point:
    return _Point(equilibrium.state, equilibrium.depth, equilibrium.force, equilibrium.energy)
