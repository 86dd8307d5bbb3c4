"""Local relaxation of the contact under a skin with bending stiffness."""

from __future__ import annotations

from typing import Final

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.numerics.problem import Problem

from .contact_cg import InnerSolution
from .preconditioner import OnContact

# Enough steps to relax waves of up to about twenty cells; inner solves relax longer waves.
_STEPS: Final = 160


def relaxed(
    problem: Problem, on_contact: OnContact, solution: InnerSolution, margin: float
) -> tuple[Mask, Array]:
    """Return the contact and the forces [Pa] after local relaxation of an inner solution.

    With bending stiffness the pressure alternates from cell to cell along the contact edge: the
    neighbours of a released cell take over its load, and a cell that joins unloads its own. So
    cells cannot change sides one by one. Instead ½⟨e, K e⟩ + ⟨p, e⟩ is minimised over gap
    increments e ≥ −gap, K being the stiffness of the grid as if it were periodic, by projected
    gradients with momentum (Beck & Teboulle 2009) and restart (O'Donoghue & Candès 2015). The start
    is the increment that closes the gap on the contact, extended by E. Off the contact a gap down
    to −``margin`` [m] is allowed. Where the relaxation has not converged, forces remain off the
    contact.
    """
    stiffness, contact = on_contact.preconditioner.grid_stiffness, on_contact.contact
    gap, _ = problem.gap(solution.displacement, contact)
    gap[~contact] += margin
    size = float(np.abs(solution.pressure).max())
    floor = (gap * (-stiffness.greatest / size)).astype(np.float32)
    load = (solution.pressure / size).astype(np.float32)
    increment = np.maximum(floor, on_contact.extended(floor[contact]))
    ahead, momentum = increment, 1.0
    for _ in range(_STEPS):
        step = stiffness(ahead)
        step += load
        np.subtract(ahead, step, out=step)
        before, increment = increment, np.maximum(step, floor, out=step)
        change = increment - before
        if np.vdot(ahead - increment, change) > 0:
            momentum = 1.0
        last, momentum = momentum, (1 + np.sqrt(1 + 4 * momentum**2)) / 2
        change *= np.float32((last - 1) / momentum)
        change += increment
        ahead = change
    load += stiffness(increment)
    return increment <= floor, load.astype(np.float64) * size
