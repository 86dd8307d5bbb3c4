"""The published method: projected conjugate gradients."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from pellicle import hookimpl
from pellicle.arrays import Array, Mask
from pellicle.components import Solver
from pellicle.grid import Grid
from pellicle.numerics.problem import Problem
from pellicle.numerics.solution import State

from .initial_guess import first_guess, with_force
from .products import dot
from .scaling import ScaledSolver

# Contact is added only where penetration is at least this share of the error inside.
_PROPORTION = 0.3
# Stands for −inf in products with 0.
_NO_INDENTER = -1e200


@dataclass
class _State:
    """Arrays of the grid's shape, reused from step to step."""

    profile: Array
    pressure: Array
    displacement: Array
    """A p, by recurrence or afresh."""
    fresh: bool
    """Whether the displacement was just computed and not updated."""
    contact: Mask
    direction: Array
    energy: float = 0.0
    """Σ gap² over the contact at the last step; 0 starts from steepest descent."""
    gap: Array = None  # type: ignore[assignment]
    inner_gap: Array = None  # type: ignore[assignment]
    """The gap in contact, 0 elsewhere."""
    scratch: Array = None  # type: ignore[assignment]
    scale: float = 1.0
    """Height range of the indenter in contact [m]."""
    inside: float = 0.0
    """max |gap| in contact [m]."""
    outside: float = 0.0
    """Penetration outside the contact [m]."""


class ConjugateGradient(ScaledSolver):
    """Polonsky & Keer 1999 for a force, Pohrt & Li 2014 for a depth.

    Departures from the papers: (1) the displacement is updated by the recurrence u ← u − τ A t and
    applied afresh only where pressure was clipped or contact added, and before the end; (2) it
    ends on the residuals that a run reports, not on the change of the pressure; (3) contact is
    added only when the penetration is no longer small against the error inside: adding at once
    lets cells at the edge flip for ever when the tension is high.
    """

    type: Literal["conjugate_gradient"] = "conjugate_gradient"

    def begin(self, problem: Problem, start: State | None) -> _State:
        """Return the state of a first guess: the last step's pressure, or one from the profile."""
        if start is not None and start.contact.any():
            pressure = with_force(problem, start.pressure.copy())
        else:
            pressure = with_force(problem, first_guess(problem))
        state = _State(
            profile=np.maximum(problem.profile, _NO_INDENTER),
            pressure=pressure,
            displacement=problem.operator(pressure),
            fresh=True,
            contact=pressure > 0,
            direction=np.zeros_like(pressure),
        )
        state.gap, state.inner_gap, state.scratch = (np.empty_like(pressure) for _ in range(3))
        _open_gap(problem, state, contact_changed=True)
        return state

    def residual(self, problem: Problem, state: _State) -> float:
        """Return max(|gap| in contact, penetration outside) over the height range in contact."""
        residual = max(state.inside, state.outside) / state.scale
        if residual <= self.tolerance and not state.fresh:
            # The recurrence gathers round-off; only a fresh displacement may end the iteration.
            state.displacement = problem.operator(state.pressure)
            state.fresh = True
            _open_gap(problem, state, contact_changed=False)
            residual = max(state.inside, state.outside) / state.scale
        return residual

    def arrays(self, grid: Grid) -> float:
        """Return the seven arrays of the state, the contact, and what changes the displacement."""
        return 8.5

    def pressure(self, state: _State) -> Array:
        """Return the pressure of a state."""
        return state.pressure

    def step(self, problem: Problem, state: _State) -> _State:
        """Return the state after one projected step along the conjugate direction."""
        pressure, direction = state.pressure, state.direction
        energy = dot(state.inner_gap, state.inner_gap)
        # Directions of cells that left the contact must go even where the search starts anew.
        direction *= state.contact
        direction *= energy / state.energy if state.energy else 0.0
        direction += state.inner_gap
        change = problem.operator(direction)
        length = _step_length(problem, state, change)
        np.multiply(direction, length, out=state.scratch)
        pressure -= state.scratch
        clipped = bool(pressure.min() < 0)
        if clipped:
            np.maximum(pressure, 0, out=pressure)
        added = state.outside > _PROPORTION * state.inside and _add(state, length)
        state.energy = 0.0 if added else energy
        factor = 1.0
        if problem.prescribed == "force":
            factor = problem.value / (float(pressure.sum()) * problem.grid.cell_area)
            pressure *= factor
        state.fresh = clipped or added
        if state.fresh:
            np.greater(pressure, 0, out=state.contact)
            state.displacement = problem.operator(pressure)
        else:
            change *= length
            state.displacement -= change
            state.displacement *= factor
        _open_gap(problem, state, contact_changed=state.fresh)
        return state


def _step_length(problem: Problem, state: _State, change: Array) -> float:
    """Return the step that minimises the energy along the direction, at constant load if given."""
    slope = dot(state.inner_gap, state.direction)
    curvature = dot(state.direction, change)
    if problem.prescribed == "force":
        response = dot(change, state.contact)
        cells = float(np.count_nonzero(state.contact))
        curvature -= float(state.direction.sum()) * response / cells
    if curvature > 0:
        return slope / curvature
    return _cell_stiffness(problem)


def _cell_stiffness(problem: Problem) -> float:
    """Return pressure over displacement [Pa/m] of one cell pressed alone.

    The step where there is no direction: no contact yet, or a single cell under a given force.
    """
    alone = np.zeros(problem.grid.shape)
    lowest = np.unravel_index(int(problem.profile.argmax()), problem.grid.shape)
    alone[lowest] = 1.0
    return 1.0 / float(problem.operator(alone)[lowest])


def _open_gap(problem: Problem, state: _State, *, contact_changed: bool) -> None:
    """Set the gap and what follows from it; with a force prescribed its depth is the mean one."""
    gap, inner_gap = state.gap, state.inner_gap
    np.subtract(state.displacement, state.profile, out=gap)
    depth = problem.value
    if problem.prescribed == "force":
        np.multiply(gap, state.contact, out=inner_gap)
        depth = float(inner_gap.sum()) / float(np.count_nonzero(state.contact))
    gap -= depth
    np.multiply(gap, state.contact, out=inner_gap)
    state.inside = max(float(inner_gap.max()), -float(inner_gap.min()))
    np.subtract(gap, inner_gap, out=state.scratch)
    state.outside = -float(state.scratch.min(initial=0.0))
    if contact_changed:
        total = float(state.pressure.sum())
        state.scale = problem.height_scale(state.contact, depth, total)


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
