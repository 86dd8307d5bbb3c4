"""The linear problem on a fixed contact: the pressure that closes the gap."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pellicle.operators import Array
from pellicle.problem import Problem

from .preconditioner import OnContact
from .products import dot

# The error shrinks by this factor before the contact is looked at again.
_REDUCTION: Final = 0.03


class Inner(NamedTuple):
    """What an inner solve found."""

    pressure: Array
    """Of either sign [Pa]; 0 off the contact."""
    displacement: Array
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
    as it is, until the error is at ``goal`` [m].
    """
    contact = preconditioner.contact
    search = _Search(preconditioner, keeps_force=problem.prescribed == "force")
    aloft = displacement - problem.profile
    depth = problem.value if problem.prescribed == "depth" else float(aloft[contact].mean())
    residual = np.where(contact, depth - aloft, 0.0)
    pressure, displacement = pressure.copy(), displacement.copy()
    next_look = max(_REDUCTION * error, goal)
    direction = search(residual)
    descent = dot(residual, direction)
    while descent > 0:
        change = problem.operator(direction)
        curvature = dot(direction, change)
        if curvature <= 0:
            break
        length = descent / curvature
        pressure += length * direction
        change *= length
        displacement += change
        residual -= change * contact
        error = search.error(residual)
        if error <= next_look:
            settled = pressure.min() >= 0 and not _penetrates(problem, displacement, contact, error)
            if error <= goal or not settled:
                break
            next_look = max(_REDUCTION * next_look, goal)
        ascent = search(residual)
        before, descent = descent, dot(residual, ascent)
        direction *= descent / before
        direction += ascent
    return Inner(pressure, displacement, error)


def _penetrates(
    problem: Problem, displacement: Array, contact: NDArray[np.bool_], error: float
) -> bool:
    gap = displacement - problem.profile
    depth = problem.value if problem.prescribed == "depth" else float(gap[contact].mean())
    return bool(((gap < depth - error) & ~contact).any())


class _Search:
    """Search directions on a contact: preconditioned, and free of force if that is prescribed."""

    def __init__(self, preconditioner: OnContact, *, keeps_force: bool) -> None:
        self._preconditioner = preconditioner
        self._keeps_force = keeps_force
        self._contact = preconditioner.contact
        if keeps_force:
            self._lift = preconditioner(self._contact.astype(np.float64))
            self._lift /= float(self._lift.sum())

    def __call__(self, residual: Array) -> Array:
        direction = self._preconditioner(residual)
        if self._keeps_force:
            direction -= self._lift * float(direction.sum())
        return direction

    def error(self, residual: Array) -> float:
        """Return max |gap| on the contact; with a given force the mean gap is the depth's."""
        if not self._keeps_force:
            return max(float(residual.max()), -float(residual.min()))
        inside = residual[self._contact]
        mean = float(inside.mean())
        return max(float(inside.max()) - mean, mean - float(inside.min()))
