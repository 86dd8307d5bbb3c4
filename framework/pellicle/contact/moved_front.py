"""The start of a load step of a contact that sticks: its front moved on as it moved last.

A start that lies past a barrier of the energy leads to another equilibrium than the last state
does. Of 826 random steps of contacts with several edges 11 would have started there, and 4 of 324
of a single edge that moves far, but none of 1,842 with a single edge that moves little.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.grid import Grid

from .masks import label_parts
from .solution import Solution, State, Stop

# Cells along the front over which its shift is averaged: a lattice gives each front to half a cell.
_SMOOTH: Final = 4.0
# Pressure of cells that join, over the greatest.
_JOINING: Final = 1e-9
# Greatest change of the area, as a factor: beyond, most contacts that shrink are lost.
_FARTHEST: Final = 1.5


def moved_on(before: State, last: State, ratio: float, grid: Grid, covered: Mask) -> State:
    """Return the last state with its front moved by ``ratio`` times its shift since ``before``.

    Along the normal of the front, wall pressure and traction keep their distance from it. It is
    the last state itself if one of the three contacts has not a single edge, or if the area would
    change by half. Only cells ``covered`` by the indenter join.
    """
    from scipy.ndimage import gaussian_filter, map_coordinates

    if not (_has_one_edge(before.contact, grid) and _has_one_edge(last.contact, grid)):
        return last
    mode = "grid-wrap" if grid.boundary == "periodic" else "nearest"
    earlier, distance = (_distance(state.contact, grid) for state in (before, last))
    moved = ratio * (distance - earlier)
    cell = max(grid.spacing)
    width = 2 * max(cell, float(np.abs(moved).max(where=np.abs(distance) < 2 * cell, initial=0.0)))
    near = np.exp(-np.square(distance / width))
    share = np.maximum(gaussian_filter(near, _SMOOTH, mode=mode), _JOINING)
    moved = gaussian_filter(moved * near, _SMOOTH, mode=mode) / share
    places = np.indices(grid.shape, dtype=np.float64)
    smooth = gaussian_filter(distance, 1.0, mode=mode)
    for axis, spacing in enumerate(grid.spacing):
        if grid.shape[axis] > 1:
            places[axis] += moved * np.gradient(smooth, spacing, axis=axis) / spacing
    traction, wall = (
        map_coordinates(values, places, order=1, mode=mode)
        for values in (last.pressure - last.wall, last.wall)
    )
    contact = (distance + moved < 0) & covered
    growth = np.count_nonzero(contact) / np.count_nonzero(last.contact)
    if not (1 / _FARTHEST < growth < _FARTHEST and _has_one_edge(contact, grid)):
        return last
    wall = np.where(contact, np.maximum(wall, _JOINING * float(wall.max())), 0.0)
    return State(wall + traction, wall, last.depth)


def is_on_path(solution: Solution, grid: Grid) -> bool:
    """Return whether a solution from a moved front is one that the last state leads to as well.

    A front that runs off may have been moved past a barrier.
    """
    return solution.stop is Stop.DONE and _has_one_edge(solution.state.contact, grid)


def _has_one_edge(contact: Mask, grid: Grid) -> bool:
    """Return whether a contact is one patch without holes that does not fill the domain."""
    patches = label_parts(contact, grid.boundary, 4)[1], label_parts(~contact, grid.boundary, 8)[1]
    return patches == (1, 1)


def _distance(contact: Mask, grid: Grid) -> Array:
    """Return the distance of each cell from the edge of a contact [m], negative inside."""
    from scipy.ndimage import distance_transform_edt

    half = 0.5 * max(grid.spacing)
    outside, inside = (
        distance_transform_edt(mask, sampling=grid.spacing) - half for mask in (~contact, contact)
    )
    distance: Array = np.where(contact, -inside, outside)
    return distance
