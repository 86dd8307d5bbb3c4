"""The linear problem on a fixed contact: the pressure that closes the gap."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from pellicle.operators import Array
from pellicle.problem import Problem

from .preconditioner import Cells, OnContact
from .products import dot

# The error shrinks by this factor before the contact is looked at again: by more for a stiffness of
# an order above 2, where a small gap is a large pressure, whose sign decides.
_REDUCTION: Final = 0.03
# No solve shrinks the error by more than this: the operator is applied in single precision, which
# has no more digits, and the next solve starts from a displacement in double.
_SINGLE: Final = 1e-5
# Iterations without a smaller error after which round-off is taken to be all that is left of it.
_PATIENCE: Final = 50


class Inner(NamedTuple):
    """What an inner solve found."""

    pressure: Array
    """Of either sign [Pa]; 0 off the contact."""
    displacement: Array
    """To the digits of single precision in what has changed [m]."""
    error: float
    """max |gap| on the contact [m]."""


def inner_solve(
    problem: Problem,
    preconditioner: OnContact,
    pressure: Array,
    displacement: Array,
    error: float,
    goal: float,
) -> Inner:
    """Return the pressure on a contact whose gap is nearly closed.

    Preconditioned conjugate gradients, with a prescribed force in the space of pressures that keep
    it. They go on beyond the first reduction of ``error`` [m] for as long as the contact would stay
    as it is, until the error is at ``goal`` [m]. All vectors are on the cells of the contact, but
    the displacement, which tells where else the surface penetrates.

    The operator is applied in single precision, in less than half of the time: to solve again for
    what is left recovers all digits (iterative refinement; Wilkinson 1963).
    """
    cells = preconditioner.cells
    if not cells.size:
        return Inner(np.zeros(problem.grid.shape), np.zeros(problem.grid.shape), 0.0)
    search = _Search(preconditioner, keeps_force=problem.prescribed == "force")
    whole = np.zeros(problem.grid.shape, dtype=np.float32)
    displacement = displacement.copy()
    goal = max(goal, _SINGLE * error)
    pressed = pressure.ravel()[cells]
    aloft = displacement.ravel()[cells] - problem.profile.ravel()[cells]
    residual = problem.depth(aloft) - aloft
    reduction = _REDUCTION ** max(1.0, preconditioner.order / 2)
    next_look = max(reduction * error, goal)
    best, since_best = np.inf, 0
    direction = search(residual)
    descent = dot(residual, direction)
    while descent > 0 and since_best < _PATIENCE:
        size = float(np.abs(direction).max())
        whole.ravel()[cells] = direction / size
        change = problem.operator(whole)
        inside = change.ravel()[cells] * size
        curvature = dot(direction, inside)
        if curvature <= 0:
            break
        length = descent / curvature
        change *= length * size
        displacement += change
        inside *= length
        residual -= inside
        direction *= length
        pressed += direction
        error = search.error(residual)
        best, since_best = (error, 0) if error < best else (best, since_best + 1)
        if error <= next_look:
            settled = pressed.min() >= 0 and not _penetrates(problem, displacement, cells, error)
            if error <= goal or not settled:
                break
            next_look = max(reduction * next_look, goal)
        ascent = search(residual)
        before, descent = descent, dot(residual, ascent)
        # The direction was multiplied by its step length.
        direction *= curvature / before * (descent / before)
        direction += ascent
    pressure = np.zeros(problem.grid.shape)
    pressure.ravel()[cells] = pressed
    return Inner(pressure, displacement, error)


def _penetrates(problem: Problem, displacement: Array, cells: Cells, error: float) -> bool:
    """Whether the surface penetrates off the contact by more than ``error`` [m]."""
    gap = displacement - problem.profile
    inside = gap.ravel()[cells]
    deepest = problem.depth(inside) - error
    return bool(np.count_nonzero(gap < deepest) > np.count_nonzero(inside < deepest))


class _Search:
    """Search directions on a contact: preconditioned, and free of force if that is prescribed."""

    def __init__(self, preconditioner: OnContact, *, keeps_force: bool) -> None:
        self._preconditioner = preconditioner
        self._keeps_force = keeps_force
        if keeps_force:
            self._lift = preconditioner(np.ones(preconditioner.cells.size))
            self._lift /= float(self._lift.sum())

    def __call__(self, residual: Array) -> Array:
        if not self._keeps_force:
            return self._preconditioner(residual)
        # The mean has no effect but on round-off: single precision must not spend its digits on it.
        direction = self._preconditioner(residual - residual.mean())
        direction -= self._lift * float(direction.sum())
        return direction

    def error(self, residual: Array) -> float:
        """Return max |gap| on the contact; with a given force the mean gap is the depth's."""
        mean = float(residual.mean()) if self._keeps_force else 0.0
        return max(float(residual.max()) - mean, mean - float(residual.min()))
