"""Nested grids, a primal–dual active set, and a preconditioner that knows the contact's edge."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from pellicle import hookimpl
from pellicle.components import IterativeSolver, Solver
from pellicle.operators import Array
from pellicle.problem import Problem, height_scale
from pellicle.transfer import prolong

from .preconditioner import Preconditioner

# A coarse grid is solved to this share of the height range only: its own error is larger.
_COARSE_TOLERANCE: Final = 1e-3
# Grids with fewer cells along their shorter edge are not coarsened.
_COARSEST: Final = 48
# Each inner solve shrinks the error by this factor before the contact is looked at again.
_REDUCTION: Final = 0.1
# The share of the tolerance to which inner solves go, and beyond which contact is added.
_MARGIN: Final = 0.5
import os
TRUST=float(os.environ.get('TRUST','1'))
_REDUCTION=float(os.environ.get('RED','0.1'))


@dataclass
class _State:
    pressure: Array
    """≥ 0 [Pa]."""
    displacement: Array
    gap: Array
    """u − δ − f [m]."""
    contact: NDArray[np.bool_]
    """Where the next inner solve puts pressure: pressure now, or penetration."""
    scale: float
    """Height range of the indenter in contact [m]."""
    error: float
    """max(|gap| under pressure, penetration) [m]."""
    preconditioner: Preconditioner


class ActiveSet(IterativeSolver):
    """Solver whose operator applications grow neither with the grid nor with the tension.

    The contact is guessed on a coarser grid, an inner conjugate gradient solve finds the pressure
    that closes the gap on it, cells that would need suction leave and cells that penetrate join.
    """

    type: Literal["active_set"] = "active_set"

    def begin(self, problem: Problem, start: Array | None) -> _State:
        """Return the state of the last step's pressure, or of the solution on a coarser grid."""
        pressure = start if start is not None and start.any() else self._cold_start(problem)
        if problem.prescribed == "force":
            pressure = pressure * (problem.value / (pressure.sum() * problem.grid.cell_area))
        return _measured(
            problem,
            pressure,
            problem.operator(pressure),
            Preconditioner(problem.operator),
            _MARGIN * self.tolerance,
        )

    def residual(self, problem: Problem, state: _State) -> float:
        """Return max(|gap| in contact, penetration outside) over the height range in contact."""
        return state.error / state.scale

    def pressure(self, state: _State) -> Array:
        """Return the pressure of a state."""
        return state.pressure

    def patience(self, problem: Problem) -> int:
        """Return how many outer iterations may bring no progress."""
        return 12

    def step(self, problem: Problem, state: _State) -> _State:
        """Return the state after one inner solve and one look at the contact."""
        pressure, displacement, inner = _inner_solve(problem, state, _MARGIN * self.tolerance)
        gap=_gap(problem, displacement, state.contact)
        contact=np.where(state.contact, pressure>0, gap< -TRUST*inner)
        if float(pressure.min()) < 0:
            np.maximum(pressure, 0, out=pressure)
            if problem.prescribed == "force":
                pressure *= problem.value / (float(pressure.sum()) * problem.grid.cell_area)
            displacement = problem.operator(pressure)
        return _measured(
            problem, pressure, displacement, state.preconditioner, _MARGIN * self.tolerance,contact
        )

    def _cold_start(self, problem: Problem) -> Array:
        coarse = problem.coarsened() if min(problem.grid.shape) > _COARSEST else None
        if coarse is None or not coarse.touches:
            return _guess(problem)
        solver = self.model_copy(
            update={"tolerance": max(self.tolerance, _COARSE_TOLERANCE)}
        )
        solution = solver.solve(coarse, None, lambda iteration, excess: None)
        return prolong(solution.pressure, problem.grid.shape) if solution.pressure.any() else _guess(problem)


def _guess(problem: Problem) -> Array:
    if problem.prescribed == "force":
        return np.isfinite(problem.profile).astype(np.float64)
    overlap = np.maximum(problem.profile + problem.value, 0.0)
    response = problem.operator(overlap)
    return overlap * (float(np.vdot(overlap, overlap)) / float(np.vdot(overlap, response)))


def _measured(
    problem: Problem,
    pressure: Array,
    displacement: Array,
    preconditioner: Preconditioner,
    margin: float,contact=None
) -> _State:
    """Return the state of a pressure ≥ 0 whose displacement is known."""
    pressed = pressure > 0
    gap = displacement - problem.profile
    depth = problem.value
    if problem.prescribed == "force":
        depth = float(gap[pressed].mean())
    gap -= depth
    scale = height_scale(problem.profile, pressed, depth)
    inside = float(np.abs(gap[pressed]).max(initial=0.0))
    if contact is None: contact = pressed | (gap < -margin * scale)
    return _State(
        pressure=pressure,
        displacement=displacement,
        gap=gap,
        contact=contact,
        scale=scale,
        error=max(inside, -float(gap.min(initial=0.0))),
        preconditioner=preconditioner,
    )


def _inner_solve(problem: Problem, state: _State, margin: float) -> tuple[Array, Array, float]:
    """Return pressure of either sign and displacement that nearly close the gap on the contact.

    Preconditioned conjugate gradients; with a force prescribed, in the space of pressures that do
    not change it. The search goes on for as long as the contact would stay as it is.
    """
    contact, apply = state.contact, problem.operator
    pressure, displacement = state.pressure.copy(), state.displacement.copy()
    precondition = _Projected(state.preconditioner, contact, problem.prescribed == "force")
    floor = margin * state.scale
    error = state.error
    goal = max(_REDUCTION * state.error, floor)
    residual = np.where(contact, -state.gap, 0.0)
    direction = precondition(residual)
    descent = float(np.vdot(residual, direction))
    while descent > 0:
        change = apply(direction)
        curvature = float(np.vdot(direction, change))
        if curvature <= 0:
            break
        length = descent / curvature
        pressure += length * direction
        change *= length
        displacement += change
        residual -= np.where(contact, change, 0.0)
        error = precondition.error(residual)
        if error <= goal:
            if error <= floor or float(pressure.min()) < 0 or _penetrates(problem, contact, displacement, error):
                break
            goal = max(_REDUCTION * goal, floor)
        ascent = precondition(residual)
        descent, before = float(np.vdot(residual, ascent)), descent
        direction *= descent / before
        direction += ascent
    return pressure, displacement, max(error,floor)


def _gap(problem, displacement, contact):
    gap = displacement - problem.profile
    depth = problem.value if problem.prescribed == "depth" else float(gap[contact].mean())
    return gap - depth

def _penetrates(problem, contact, displacement, floor):
    gap = _gap(problem, displacement, contact)
    return bool(((gap < -floor) & ~contact).any())


class _Projected:
    """The preconditioner on a contact, within pressures of no net force if the force is given."""

    def __init__(self, preconditioner, contact, keeps_force):
        self._apply = preconditioner
        self._contact = contact
        preconditioner.restrict(contact)
        self._lift = preconditioner(contact.astype(np.float64)) if keeps_force else None
        self._cells = np.count_nonzero(contact)

    def __call__(self, residual):
        direction = self._apply(residual)
        if self._lift is not None:
            direction -= self._lift * (float(direction.sum()) / float(self._lift.sum()))
        return direction

    def error(self, residual):
        if self._lift is None:
            return float(np.abs(residual).max())
        mean = float(residual.sum()) / self._cells
        return float(np.abs(residual[self._contact] - mean).max())


@hookimpl
def register_solvers(register: Callable[[type[Solver]], None]) -> None:
    """Register the solver."""
    register(ActiveSet)
