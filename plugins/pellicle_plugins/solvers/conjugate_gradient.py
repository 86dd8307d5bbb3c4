"""Projected conjugate gradients, the published method."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from pellicle import Grid
from pellicle.arrays import Array, Mask
from pellicle.contact import Problem, State, dot, first_guess, with_force

from .scaling import ScaledSolver

# Contact is added only where the penetration is at least this share of the error inside.
_PROPORTION: Final = 0.3
# Replaces −inf, whose product with 0 is NaN.
_NO_INDENTER: Final = -1e200


@dataclass(frozen=True)
class _Iterate:
    """A pressure and its gap; the next iterate reuses the arrays, all of the grid's shape."""

    profile: Array
    pressure: Array
    displacement: Array
    """A p [m], by recurrence or by an application of the operator."""
    contact: Mask
    direction: Array
    gap: Array
    """Gap [m]; under force control its mean over the contact is 0."""
    inner_gap: Array
    """The gap in contact, 0 elsewhere."""
    scratch: Array
    energy: float = 0.0
    """Σ gap² over the contact at the last step [m²]; 0 restarts with steepest descent."""
    scale: float = 1.0
    """Height range of the indenter in contact [m]."""
    inside: float = 0.0
    """max |gap| in contact [m]."""
    outside: float = 0.0
    """Penetration outside the contact [m]."""

    def with_gap(self, problem: Problem, *, contact_changed: bool = False) -> _Iterate:
        """Return the iterate with the gap of its displacement, and the errors of that gap."""
        gap, inner_gap, contact = self.gap, self.inner_gap, self.contact
        np.subtract(self.displacement, self.profile, out=gap)
        depth = problem.value
        if problem.prescribed == "force":
            np.multiply(gap, contact, out=inner_gap)
            depth = float(inner_gap.sum()) / float(np.count_nonzero(contact))
        gap -= depth
        np.multiply(gap, contact, out=inner_gap)
        np.subtract(gap, inner_gap, out=self.scratch)
        scale = self.scale
        if contact_changed:
            scale = problem.height_scale(contact, depth, float(self.pressure.sum()))
        return replace(
            self,
            scale=scale,
            inside=max(float(inner_gap.max()), -float(inner_gap.min())),
            outside=-float(self.scratch.min(initial=0.0)),
        )


class ConjugateGradient(ScaledSolver):
    """Polonsky & Keer 1999 under force control, Pohrt & Li 2014 under depth control.

    This differs from the papers in three points:

    1. The displacement is updated by the recurrence u ← u − τ A t. The operator is applied afresh
       only after pressure was clipped or contact was added, and before the end.
    2. The iteration ends by the residuals that a run reports, not by the change of the pressure.
    3. Contact is added only when the penetration is not small compared with the error inside. Under
       high tension, cells at the edge would otherwise change sides for ever.
    """

    type: Literal["conjugate_gradient"] = "conjugate_gradient"
    examples = ({"tolerance": 1e-09},)

    def begin(self, problem: Problem, start: State | None) -> _Iterate:
        """Return the iterate of the pressure of the last step, or of an initial guess."""
        if start is not None and start.contact.any():
            pressure = np.array(with_force(problem, start.pressure))
        else:
            pressure = first_guess(problem)
        first = _Iterate(
            profile=np.maximum(problem.profile, _NO_INDENTER),
            pressure=pressure,
            displacement=problem.operator(pressure),
            contact=pressure > 0,
            direction=np.zeros_like(pressure),
            gap=np.empty_like(pressure),
            inner_gap=np.empty_like(pressure),
            scratch=np.empty_like(pressure),
        )
        return first.with_gap(problem, contact_changed=True)

    def residual(self, problem: Problem, state: _Iterate) -> float:
        """Return max(|gap| in contact, penetration outside) over the height range in contact."""
        return max(state.inside, state.outside) / state.scale

    def arrays(self, grid: Grid) -> float:
        """Return the seven arrays of the iterate, the contact, and the change of displacement."""
        return 8.5

    def pressure(self, state: _Iterate) -> Array:
        """Return the pressure of an iterate."""
        return state.pressure

    def step(self, problem: Problem, state: _Iterate) -> _Iterate:
        """Return the iterate after one projected step along the conjugate direction."""
        pressure, direction = state.pressure, state.direction
        energy = dot(state.inner_gap, state.inner_gap)
        # Cells that left the contact have no search direction, even after a restart.
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
        added = False
        if state.outside > _PROPORTION * state.inside:
            penetrating = (state.gap < 0) & (pressure == 0)
            added = bool(penetrating.any())
            pressure[penetrating] -= length * state.gap[penetrating]
        factor = 1.0
        if problem.prescribed == "force":
            factor = problem.value / (float(pressure.sum()) * problem.grid.cell_area)
            pressure *= factor
        state = replace(state, energy=0.0 if added else energy)
        if clipped or added:
            np.greater(pressure, 0, out=state.contact)
            displacement = problem.operator(pressure)
            return replace(state, displacement=displacement).with_gap(problem, contact_changed=True)
        change *= length
        displacement = state.displacement
        displacement -= change
        displacement *= factor
        state = state.with_gap(problem)
        if self.residual(problem, state) <= self.tolerance:
            # The recurrence accumulates round-off, so the operator is applied before the end.
            state = replace(state, displacement=problem.operator(pressure)).with_gap(problem)
        return state


def _step_length(problem: Problem, state: _Iterate, change: Array) -> float:
    """Return the step [Pa/m] that minimises the energy along the direction at a given load."""
    slope = dot(state.inner_gap, state.direction)
    curvature = dot(state.direction, change)
    if problem.prescribed == "force":
        mean = dot(change, state.contact) / float(np.count_nonzero(state.contact))
        curvature -= float(state.direction.sum()) * mean
    if curvature > 0:
        return slope / curvature
    # Without contact, or with one cell under a given force, the stiffness of a single cell is used.
    single = np.zeros(problem.grid.shape)
    lowest = np.unravel_index(int(problem.profile.argmax()), problem.grid.shape)
    single[lowest] = 1.0
    return 1.0 / float(problem.operator(single)[lowest])
