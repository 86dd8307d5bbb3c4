"""Which cells press under a skin that bends, as the stiffness of those around them tells."""

from __future__ import annotations

from typing import Final

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.numerics.problem import Problem

from .circulant_stiffness import Stiffness
from .contact_cg import Inner
from .preconditioner import OnContact

# Waves of up to about twenty cells settle; the longer ones are for the inner solves.
_STEPS: Final = 160


def relaxed(
    problem: Problem, stiffness: Stiffness, on_contact: OnContact, found: Inner, margin: float
) -> tuple[Mask, Array]:
    """Return the contact and forces [Pa] once the cells that are wrong have moved others.

    What bends presses along its edge in a pattern of single cells: one that lets go is made up for
    by its neighbours, one that is lifted takes from them. So the gap that the inner solve left is
    opened by e ≥ −gap such that ½⟨e, K e⟩ + ⟨p, e⟩ is least, K being the ``stiffness`` of the grid
    as if it were periodic: from what closes the gap on the contact, extended by E, by steps down
    the gradient with momentum (Beck & Teboulle 2009), anew where that leads uphill (O'Donoghue &
    Candès 2015). Off the contact the gap may be as negative as ``margin`` [m]. What did not settle
    leaves forces off the contact.
    """
    contact = on_contact.contact
    gap = found.displacement - problem.profile
    gap -= problem.depth(gap[contact])
    gap[~contact] += margin
    size = float(np.abs(found.pressure).max())
    floor = (gap * (-stiffness.greatest / size)).astype(np.float32)
    load = (found.pressure / size).astype(np.float32)
    opened = np.maximum(floor, on_contact.extended(floor[contact]))
    ahead, momentum = opened, 1.0
    for _ in range(_STEPS):
        step = stiffness(ahead)
        step += load
        np.subtract(ahead, step, out=step)
        before, opened = opened, np.maximum(step, floor, out=step)
        change = opened - before
        if np.vdot(ahead - opened, change) > 0:
            momentum = 1.0
        last, momentum = momentum, (1 + np.sqrt(1 + 4 * momentum**2)) / 2
        change *= np.float32((last - 1) / momentum)
        change += opened
        ahead = change
    load += stiffness(opened)
    return opened <= floor, load.astype(np.float64) * size
