"""Extrapolate the last two load steps of a path to the control of the next one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from pellicle.arrays import Array

from .problem import Depth, Problem
from .solution import State

# Longest step, over the last one, to which is extrapolated.
_FARTHEST: Final = 2.0
# Beside a smooth contact the gap grows with this power of the distance.
_GAP_POWER: Final = 1.5
# Pressure of cells that join, over the greatest.
_JOINING: Final = 1e-9


class PathPoint(NamedTuple):
    """A load step as the start of an extrapolation."""

    state: State
    gap: Array
    """Gap [m]; +inf where there is no indenter."""
    energy: float = np.nan
    """`Equilibrium.energy` [J]; NaN if it is not known."""


def start_of(problem: Problem, state: State | None, path: Sequence[PathPoint]) -> State | None:
    """Return the start of a load step: the last two extrapolated to its control, or the last state.

    ``path`` has the last two load steps, the earlier one first; fewer if there are no more.
    Nothing is extrapolated across a reversal of the path, to more than twice the last step, and in
    a solid that relaxes, whose next state also depends on what earlier steps have left behind.
    Neither is it with a law, where there may be several equilibria: the descent from the last state
    ends in the one that the path leads to.
    """
    if state is None or len(path) < 2 or problem.left is not None or problem.law:
        return state
    before, last = path
    reached = [_control(problem, point.state) for point in (before, last)]
    step = reached[1] - reached[0]
    ratio = (problem.value - reached[1]) / step if step else 0.0
    touches = before.state.contact.any() and last.state.contact.any()
    if not 0 < ratio <= _FARTHEST or not touches:
        return state
    depth = last.state.depth + ratio * (last.state.depth - before.state.depth)
    pressure = _pressure_ahead(problem, before, last, ratio)
    return State(pressure, pressure, depth)


def _control(problem: Problem, state: State) -> float:
    """Return the depth of the base [m] or the force [N] of a state, as `Problem.value` is."""
    total = float(state.pressure.sum())
    if isinstance(problem.control, Depth):
        return state.depth + problem.operator.deflection(total)
    return total * problem.grid.cell_area


def _pressure_ahead(problem: Problem, before: PathPoint, last: PathPoint, ratio: float) -> Array:
    """Return the extrapolated pressure [Pa], > 0 on the extrapolated contact.

    In contact the pressure changes linearly, and cells where it falls to 0 leave. The gap of the
    cells beside the contact changes linearly too; farther away the edge moves evenly through the
    gap to the power 2/3, since the gap grows with the distance to the power 3/2. Cells whose gap
    closes join with a pressure that only marks them.
    """
    contact = last.state.contact
    pressure = last.state.pressure + ratio * (last.state.pressure - before.state.pressure)
    np.maximum(pressure, 0.0, out=pressure)
    # Only cells that came closer can join; a gap is infinite in both steps or in none.
    coming = np.flatnonzero((last.gap < before.gap) & ~contact)
    gaps = [np.maximum(point.gap.ravel()[coming], 0.0) for point in (before, last)]
    linear = gaps[1] + ratio * (gaps[1] - gaps[0])
    one, two = (gap ** (1 / _GAP_POWER) for gap in gaps)
    # Cells beside the contact have an edge in common with one of its cells.
    periodic = problem.grid.boundary == "periodic"
    padded = np.pad(contact, 1, mode="wrap" if periodic else "constant")
    rows, columns = padded[:, 1:-1], padded[1:-1]
    beside = (rows[:-2] | rows[2:] | columns[:, :-2] | columns[:, 2:]).ravel()[coming]
    joins = np.where(beside, linear, two + ratio * (two - one)) < 0
    np.put(pressure, coming[joins], _JOINING * float(pressure.max()))
    return pressure
