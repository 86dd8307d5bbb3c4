"""Shift the edge of a contact that sticks as it moved in the last load step."""

from __future__ import annotations

from typing import Final, Literal, NamedTuple

import numpy as np
from scipy.ndimage import distance_transform_edt, gaussian_filter, map_coordinates

from pellicle.arrays import Array, Mask
from pellicle.grid import Boundary, Grid

from .labels import labelled

# Lengths in cells: cells within the first of the front have its shift; it is averaged along the
# front over the second, since whole cells place it by half a cell only; beyond the third from the
# front it fades. The last is the margin in which fields continue beyond the domain.
_NEAR: Final = 3.0
_SMOOTH: Final = 2.0
_FADES: Final = 6.0
_MARGIN: Final = 32


class Traction(NamedTuple):
    """What acts on a surface in contact."""

    contact: Mask
    """The cells on which the indenter presses."""
    wall: Array
    """Wall pressure [Pa]; 0 off the contact."""
    across: Array
    """Traction across the gap [Pa]; −(strength) in contact."""


def same_patches(one: Mask, other: Mask, boundary: Boundary) -> bool:
    """Return whether each patch of one mask meets one patch of the other, and conversely.

    Cells that meet in a corner belong to one patch.
    """
    labels = [labelled(mask, boundary, 8) for mask in (one, other)]
    both = one & other
    pairs = np.unique(np.stack([label[both] for label, _ in labels]), axis=1)
    return all(
        pairs.shape[1] == number == np.unique(row).size
        for row, (_, number) in zip(pairs, labels, strict=True)
    )


def shifted(grid: Grid, before: Traction, last: Traction, ratio: float) -> Traction:
    """Return the traction after the edge of the contact has moved on by ``ratio`` times its shift.

    The shift of the front from ``before`` to ``last`` is the difference of the distances from
    both. Tractions across the gap move with the front, since they are the same function of the
    distance from it wherever it is; the wall pressure at a distance from it changes linearly.
    """
    # With a margin in which the fields go on beyond the domain.
    mode: Literal["wrap", "edge"] = "wrap" if grid.boundary == "periodic" else "edge"
    one, two = (
        Traction._make(np.pad(field, _MARGIN, mode=mode) for field in part)
        for part in (before, last)
    )
    distance = _signed_distance(two.contact, grid)
    moved = ratio * (_signed_distance(one.contact, grid) - distance)
    shift = _along_normals(_averaged(moved, distance, grid), distance, grid)
    ahead = distance - shift
    reach = _FADES * max(grid.spacing)
    shift *= np.exp(-np.square(np.minimum(np.abs(distance), np.abs(ahead)) / reach))
    slopes = [part / edge for part, edge in zip(np.gradient(distance), grid.spacing, strict=True)]
    steepness = np.maximum(np.hypot(*slopes), 0.3)
    cells = np.indices(distance.shape)

    def at(field: Array, length: Array) -> Array:
        """Return a field at a length [m] against the normal of the front."""
        places = [
            index - length * slope / steepness / edge
            for index, slope, edge in zip(cells, slopes, grid.spacing, strict=True)
        ]
        return np.asarray(map_coordinates(field, places, order=1, mode="nearest"))

    across = at(two.across, shift)
    wall = (1 + ratio) * at(two.wall, shift) - ratio * at(one.wall, shift * (1 + 1 / ratio))
    contact = ahead < 0
    inside = tuple(slice(_MARGIN, -_MARGIN) for _ in grid.shape)
    return Traction(contact[inside], wall[inside], across[inside])


def _signed_distance(contact: Mask, grid: Grid) -> Array:
    """Return the distance of each cell from the edge of the contact [m], < 0 in contact."""
    half = 0.5 * min(grid.spacing)
    outside = distance_transform_edt(~contact, sampling=grid.spacing) - half
    inside = distance_transform_edt(contact, sampling=grid.spacing) - half
    return np.asarray(np.where(contact, -inside, outside))


def _averaged(values: Array, distance: Array, grid: Grid) -> Array:
    """Return the mean of values near the front around each cell."""
    weight = np.exp(-np.square(distance / (_NEAR * max(grid.spacing))))
    total = gaussian_filter(weight, _SMOOTH)
    mean = gaussian_filter(values * weight, _SMOOTH)
    return np.asarray(np.divide(mean, total, out=np.zeros_like(mean), where=total > 1e-9))


def _along_normals(values: Array, distance: Array, grid: Grid) -> Array:
    """Return at each cell the value at the nearest cell of the front."""
    away = np.abs(distance) > max(grid.spacing)
    rows, columns = distance_transform_edt(
        away, sampling=grid.spacing, return_distances=False, return_indices=True
    )
    return np.asarray(values[rows, columns])
