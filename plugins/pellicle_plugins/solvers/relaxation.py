"""Local relaxation of the contact under a skin with bending stiffness."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from pellicle.arrays import Array, Mask
from pellicle.contact import Problem

from .biharmonic import Field
from .contact_cg import InnerSolution
from .preconditioner import CirculantStiffness, OnContact

# Enough steps to relax waves of up to about fourteen cells; inner solves relax longer waves.
_STEPS: Final = 80
# Cells around the contact beyond which the relaxation does not reach in that many steps; with 32
# instead, some contacts take four outer iterations more.
_MARGIN: Final = 48
# Cells along the rim of the window that do not move.
_RIM: Final = 2
# Share of an axis above which a window along it is not worth its two transforms of the grid.
_WHOLE: Final = 0.75
# A brief relaxation compares contacts after this many steps.
_CHECKED: Final = 10
# It ends when at most this share of the cells that it has changed changed since the last check.
_SETTLED: Final = 0.02


def relaxed(
    problem: Problem,
    on_contact: OnContact,
    solution: InnerSolution,
    margin: float,
    *,
    brief: bool = False,
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
    come from the jump of the extension across the edges of a free domain. A ``brief`` relaxation
    ends when the contact hardly changes any more.
    """
    stiffness, contact = on_contact.preconditioner.grid_stiffness, on_contact.contact
    gap, _ = problem.gap(solution.displacement, contact)
    gap[~contact] += margin
    size = float(np.abs(solution.pressure).max())
    floor = (gap * (-stiffness.greatest / size)).astype(np.float32)
    load = (solution.pressure / size).astype(np.float32)
    increment = np.maximum(floor, on_contact.extended(floor[contact]))
    load += stiffness(increment)
    floor -= increment
    changed = contact.copy()
    changed.ravel()[solution.misclassified] ^= True
    window = _window(contact | changed)
    if window is None:
        increment = _minimised(stiffness, floor, load, brief=brief)
        load += stiffness(increment)
    else:
        increment.fill(0)
        plane = on_contact.preconditioner.stiffness(floor[window].shape)
        weight = np.float32(stiffness.greatest / plane.greatest)
        rims = _rims(plane.shape, floor.shape)
        moved = _minimised(plane, floor[window], weight * load[window], brief=brief, rims=rims)
        increment[window] = moved
        load += stiffness(increment)
        outside = np.ones(load.shape, dtype=bool)
        outside[window] = False
        load[outside] = 0
    return increment <= floor, load.astype(np.float64) * size


def _minimised(
    stiffness: CirculantStiffness,
    floor: Field,
    load: Field,
    *,
    brief: bool,
    rims: Sequence[tuple[slice, slice]] = (),
) -> Field:
    """Return the e ≥ ``floor`` that nearly minimises ½⟨e, K e⟩ + ⟨load, e⟩ and is 0 on ``rims``."""
    increment = np.zeros_like(floor)
    ahead, momentum = increment, 1.0
    first = contact = increment <= floor
    for number in range(1, _STEPS + 1):
        step = stiffness(ahead)
        step += load
        np.subtract(ahead, step, out=step)
        for rim in rims:
            step[rim] = 0
        before, increment = increment, np.maximum(step, floor, out=step)
        if brief and number % _CHECKED == 0:
            last_contact, contact = contact, increment <= floor
            settled = _SETTLED * np.count_nonzero(contact ^ first)
            if np.count_nonzero(contact ^ last_contact) <= settled:
                break
        change = increment - before
        if np.vdot(ahead - increment, change) > 0:
            momentum = 1.0
        last, momentum = momentum, (1 + np.sqrt(1 + 4 * momentum**2)) / 2
        change *= np.float32((last - 1) / momentum)
        change += increment
        ahead = change
    return increment


def _window(cells: Mask) -> tuple[NDArray[np.int64], ...] | None:
    """Return the index of a rectangle around ``cells`` on their periodic plane; None for all."""
    rows, columns = (
        _interval(np.flatnonzero(cells.any(axis=1 - axis)), cells.shape[axis]) for axis in (0, 1)
    )
    return None if (rows.size, columns.size) == cells.shape else np.ix_(rows, columns)


def _interval(indices: NDArray[np.int64], number: int) -> NDArray[np.int64]:
    """Return the indices of the shortest periodic interval around some, with a margin."""
    steps = np.diff(indices, append=indices[0] + number)
    widest = int(np.argmax(steps))
    extent = number - int(steps[widest]) + 1
    length = scipy.fft.next_fast_len(extent + 2 * _MARGIN, real=True)
    if length > _WHOLE * number:
        return np.arange(number)
    start = int(indices[(widest + 1) % indices.size]) - (length - extent) // 2
    interval: NDArray[np.int64] = (start + np.arange(length)) % number
    return interval


def _rims(shape: tuple[int, int], whole: tuple[int, ...]) -> list[tuple[slice, slice]]:
    """Return the slices of a window's rims, along the axes on which it is not ``whole``."""
    every, ends = slice(None), (slice(_RIM), slice(-_RIM, None))
    rows = [(end, every) for end in ends if shape[0] < whole[0]]
    return rows + [(every, end) for end in ends if shape[1] < whole[1]]
