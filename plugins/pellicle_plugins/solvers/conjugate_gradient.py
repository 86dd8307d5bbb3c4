"""The published method: projected conjugate gradients."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pellicle import hookimpl
from pellicle.components import IterativeSolver, Solver
from pellicle.operators import Array
from pellicle.problem import Problem, height_scale


@dataclass
class _State:
    """Arrays of the grid's shape; reused from step to step."""

    pressure: Array
    displacement: Array
    """A p, by recurrence or afresh."""
    gap: Array
    """u − δ − f; −inf profile makes it +inf."""
    contact: NDArray[np.bool_]
    gap_in_contact: Array
    direction: Array
    energy: float
    """Σ gap² over the contact at the last step; 0 starts from steepest descent."""
    scale: float
    fresh: bool
    """Whether the displacement was just computed and not updated."""


class ConjugateGradient(IterativeSolver):
    """Polonsky & Keer 1999 for a force, Pohrt & Li 2014 for a depth.

    Departures from the papers: (1) the displacement is updated by the recurrence u ← u − τ A t and
    applied afresh only where pressure was clipped or contact added, and before the end; (2) it
    ends on the residuals that a run reports, not on the change of the pressure.
    """

    type: Literal["conjugate_gradient"] = "conjugate_gradient"

    def begin(self, problem: Problem, start: Array | None) -> _State:
        """Return the state of a first guess: the last step's pressure, or one from the profile."""
        pressure = _guess(problem) if start is None or not start.any() else start.copy()
        if problem.prescribed == "force":
            pressure *= problem.value / (pressure.sum() * problem.grid.cell_area)
        contact = pressure > 0
        state = _State(
            pressure=pressure,
            displacement=problem.operator(pressure),
            gap=np.empty_like(pressure),
            contact=contact,
            gap_in_contact=np.empty_like(pressure),
            direction=np.zeros_like(pressure),
            energy=0.0,
            scale=1.0,
            fresh=True,
        )
        _open_gap(problem, state, contact_changed=True)
        return state

    def residual(self, problem: Problem, state: _State) -> float:
        """Return max(|gap| in contact, penetration outside) over the height range in contact."""
        residual = _residual(state)
        if residual <= self.tolerance and not state.fresh:
            # The recurrence gathers round-off; only a fresh displacement may end the iteration.
            state.displacement = problem.operator(state.pressure)
            state.fresh = True
            _open_gap(problem, state, contact_changed=True)
            residual = _residual(state)
        return residual

    def pressure(self, state: _State) -> Array:
        """Return the pressure of a state."""
        return state.pressure

    def step(self, problem: Problem, state: _State) -> _State:
        """Return the state after one projected step along the conjugate direction."""
        pressure, gap, direction = state.pressure, state.gap, state.direction
        energy = float(np.vdot(state.gap_in_contact, state.gap_in_contact))
        # Directions of cells that left the contact must go even where the search starts anew.
        direction *= state.contact
        direction *= energy / state.energy if state.energy else 0.0
        direction += state.gap_in_contact
        change = problem.operator(direction)
        curvature = float(np.vdot(direction, change))
        if problem.prescribed == "force":
            in_contact = np.count_nonzero(state.contact)
            curvature -= float(direction.sum()) * float(change[state.contact].sum()) / in_contact
        slope = float(np.vdot(state.gap_in_contact, direction))
        length = slope / curvature if curvature > 0 else _unit_step(state)
        np.multiply(direction, length, out=state.gap_in_contact)
        pressure -= state.gap_in_contact
        clipped = float(pressure.min()) < 0
        if clipped:
            np.maximum(pressure, 0, out=pressure)
        added = not state.contact.all() and float(gap.min()) < 0 and _add(state, length)
        state.energy = 0.0 if added else energy
        exact = not clipped and not added
        state.fresh = not exact
        factor = 1.0
        if problem.prescribed == "force":
            factor = problem.value / (float(pressure.sum()) * problem.grid.cell_area)
            pressure *= factor
        if exact:
            change *= length
            state.displacement -= change
            state.displacement *= factor
        else:
            np.greater(pressure, 0, out=state.contact)
            state.displacement = problem.operator(pressure)
        _open_gap(problem, state, contact_changed=not exact)
        return state


def _guess(problem: Problem) -> Array:
    """Return a pressure that is positive wherever there can be contact, of a sensible size."""
    lowest = float(problem.profile.max())
    if problem.prescribed == "force":
        return np.isfinite(problem.profile).astype(np.float64)
    overlap = np.maximum(problem.profile + problem.value, 0.0)
    if lowest + problem.value <= 0:
        return overlap
    response = problem.operator(overlap)
    # The multiple of the overlap whose displacement comes nearest to it in energy.
    work = float(np.vdot(overlap, response))
    return overlap * (float(np.vdot(overlap, overlap)) / work)


def _open_gap(problem: Problem, state: _State, *, contact_changed: bool) -> None:
    """Set the gap and what follows from it; with a force prescribed its depth is the mean one."""
    np.subtract(state.displacement, problem.profile, out=state.gap)
    if problem.prescribed == "depth":
        depth = problem.value
    else:
        np.copyto(state.gap_in_contact, 0.0)
        np.copyto(state.gap_in_contact, state.gap, where=state.contact)
        depth = float(state.gap_in_contact.sum()) / max(np.count_nonzero(state.contact), 1)
    state.gap -= depth
    np.copyto(state.gap_in_contact, 0.0)
    np.copyto(state.gap_in_contact, state.gap, where=state.contact)
    if contact_changed:
        state.scale = height_scale(problem.profile, state.contact, depth)


def _residual(state: _State) -> float:
    inside = max(float(state.gap_in_contact.max()), 0.0)
    outside = max(-float(state.gap.min()), 0.0)
    return max(inside, outside) / state.scale


def _unit_step(state: _State) -> float:
    """Return pressure over displacement: a step length where the direction gives none."""
    displacement = float(state.displacement[state.contact].sum())
    return float(state.pressure.sum()) / displacement if displacement > 0 else 0.0


def _add(state: _State, length: float) -> bool:
    """Press where the surface penetrates without pressure; return whether it did anywhere."""
    overlap = (state.gap < 0) & (state.pressure == 0)
    if not overlap.any():
        return False
    state.pressure[overlap] -= length * state.gap[overlap]
    return True


@hookimpl
def register_solvers(register: Callable[[type[Solver]], None]) -> None:
    """Register the published method."""
    register(ConjugateGradient)
