"""Which cells press under a skin that bends, as the bending of the cells around them tells."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from pellicle.operators import Array, Operator
from pellicle.problem import Problem

from .extension import FASTEST, biharmonic, stretch_of
from .inner_solve import Inner
from .preconditioner import edges

# Waves of up to about twenty cells settle; the longer ones are for the inner solves.
_STEPS: Final = 160


def relaxed(
    problem: Problem, contact: NDArray[np.bool_], found: Inner, margin: float
) -> tuple[NDArray[np.bool_], Array]:
    """Return the contact and forces [Pa] once the cells that are wrong have moved others.

    What bends presses along its edge in a pattern of single cells: one that lets go is made up for
    by its neighbours, one that is lifted takes from them. So the gap that the inner solve left is
    opened by e ≥ −gap, K = B Δ², such that ½⟨e, K e⟩ + ⟨p, e⟩ is least: the obstacle problem that
    bending alone poses, by steps down the gradient with momentum (Beck & Teboulle 2009), anew
    where that leads uphill (O'Donoghue & Candès 2015). Off the contact the gap may be as
    negative as ``margin`` [m]. What did not settle leaves forces off the contact.
    """
    gap = found.displacement - problem.profile
    gap -= problem.depth(gap[contact])
    gap += margin
    gap[contact] = 0.0
    dx, dy = edges(problem.grid)
    stretch = stretch_of(dx, dy)
    bending = _bending(problem.operator, dx * np.sqrt(stretch[0]))
    floor = (-gap).astype(np.float32)
    load = (found.pressure / bending).astype(np.float32)
    opened = np.maximum(floor, np.float32(0))
    ahead, momentum = opened, 1.0
    for _ in range(_STEPS):
        step = biharmonic(ahead, stretch)
        step += load
        step *= np.float32(-1 / FASTEST)
        step += ahead
        before, opened = opened, np.maximum(step, floor, out=step)
        change = opened - before
        if np.vdot(ahead - opened, change) > 0:
            momentum = 1.0
        last, momentum = momentum, (1 + np.sqrt(1 + 4 * momentum**2)) / 2
        change *= np.float32((last - 1) / momentum)
        change += opened
        ahead = change
    load += biharmonic(opened, stretch)
    return opened <= floor, load.astype(np.float64) * bending


def _bending(operator: Operator, h: float) -> float:
    """Return B/h⁴ [Pa/m] from the stiffness for a wave of four edges ``h`` [m]."""
    q = np.pi / 2
    return float(1 / operator.kernel.compliance(np.array([q / h]))[0]) / q**4
