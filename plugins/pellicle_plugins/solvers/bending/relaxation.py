"""Local relaxation of the contact under a skin with bending stiffness."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.contact import Problem
from pellicle_plugins.solvers.biharmonic import Field
from pellicle_plugins.solvers.contact_cg import InnerSolution
from pellicle_plugins.solvers.preconditioner import CirculantStiffness, OnContact
from pellicle_plugins.solvers.window import window

# Enough steps to relax waves of up to about fourteen cells; inner solves relax longer waves.
_STEPS: Final = 80
# Cells around the contact beyond which the relaxation does not reach in that many steps; with 32
# instead, some contacts take four outer iterations more.
_MARGIN: Final = 48
# Cells along the rim of the window that do not move.
_RIM: Final = 2


def relax_locally(
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

    Only the cells in a window around the contact move. Forces outside it are left out: there they
    come from the jump of the extension across the edges of a free domain.
    """
    contact = on_contact.contact
    stiffness = on_contact.preconditioner.stiffness(contact.shape)
    gap, _ = problem.gap(solution.displacement, contact)
    gap[~contact] += margin
    size = float(np.abs(solution.pressure).max())
    floor = (gap * (-stiffness.greatest / size)).astype(np.float32)
    load = (solution.pressure / size).astype(np.float32)
    increment = np.maximum(floor, on_contact.extend(floor[contact]))
    load += stiffness(increment)
    floor -= increment
    changed = contact.copy()
    changed.ravel()[solution.misclassified] ^= True
    part = window(contact | changed, _MARGIN)
    plane = on_contact.preconditioner.stiffness(floor[part].shape)
    weight = np.float32(stiffness.greatest / plane.greatest)
    rims = _rims(plane.shape, floor.shape)
    moved = _minimised(plane, floor[part], weight * load[part], rims)
    increment.fill(0)
    increment[part] = moved
    load += stiffness(increment)
    outside = np.ones(load.shape, dtype=bool)
    outside[part] = False
    load[outside] = 0
    return increment <= floor, load.astype(np.float64) * size


def _minimised(
    stiffness: CirculantStiffness, floor: Field, load: Field, rims: Sequence[tuple[slice, slice]]
) -> Field:
    """Return the e ≥ ``floor`` that nearly minimises ½⟨e, K e⟩ + ⟨load, e⟩ and is 0 on ``rims``."""
    increment = np.zeros_like(floor)
    ahead, momentum = increment, 1.0
    for _ in range(_STEPS):
        step = stiffness(ahead)
        step += load
        np.subtract(ahead, step, out=step)
        for rim in rims:
            step[rim] = 0
        before, increment = increment, np.maximum(step, floor, out=step)
        change = increment - before
        if np.vdot(ahead - increment, change) > 0:
            momentum = 1.0
        last, momentum = momentum, (1 + np.sqrt(1 + 4 * momentum**2)) / 2
        change *= np.float32((last - 1) / momentum)
        change += increment
        ahead = change
    return increment


def _rims(shape: tuple[int, int], whole: tuple[int, ...]) -> list[tuple[slice, slice]]:
    """Return the slices of a window's rims, along the axes on which it is not ``whole``."""
    every, ends = slice(None), (slice(_RIM), slice(-_RIM, None))
    rows = [(end, every) for end in ends if shape[0] < whole[0]]
    return rows + [(every, end) for end in ends if shape[1] < whole[1]]
