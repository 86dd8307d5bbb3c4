"""Flat and smooth ends of an indenter, which touch as a whole although some of their cells open.

Under tension the edge of an end carries a line load, which square cells follow in steps.  Cells
within then open by up to 0.08 of what the surface falls in the cell beside the edge (s/a = 0.03 to
100, 33 to 257 points), an opening that halves with the cell.  In the continuum the lowest flat
touches everywhere: −τ₀∇²u + (E*/2)|q|u would be positive, not 0, where u is highest.
"""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.grid import Boundary

from .masks import Labels, dilate, label_parts

_OPENING = 0.15
"""Opening of an end, over the bend of the surface at its edge, that may be the cells'."""
_SMOOTH = 0.05
"""Bend of an end over that of the surface at its edge."""


def with_ends(
    contact: Mask, heights: Array, gap: Array, displacement: Array, boundary: Boundary
) -> Mask:
    """Return the contact, bool, with all parts of an end that touches and open no further.

    An end is made of blocks of 3 × 3 cells that are flat, tilted or round: their heights bend by
    far less, in second differences, than the surface does at a cell of its edge.  All arrays have
    the grid's shape (nx, ny), gap and displacement in m.
    """
    if contact.all():
        return contact
    bent = np.zeros(contact.shape)
    for axis in (0, 1):
        np.fmax(bent, -_bend(displacement, axis, boundary), out=bent, where=contact)
    most = float(bent.max(initial=0.0))
    lines, bends = [], np.zeros(contact.shape)
    for axis in (0, 1):
        bend = np.abs(_bend(heights, axis, boundary))
        lines.append(_erode(bend <= _SMOOTH * most, 1 - axis, boundary))
        np.maximum(bends, bend, out=bends)
    del bend
    middles = np.logical_and(*lines)
    opens_little = dilate(~contact & (gap <= _OPENING * most), boundary)
    # Of rough bodies no cell that may be counted is beside a block.
    if not np.any(middles & opens_little):
        return contact
    blocks, count = label_parts(middles, boundary, 8)
    ends = np.zeros_like(blocks)
    rows, columns = np.nonzero(blocks)
    for shift in np.ndindex(3, 3):
        cells = rows + shift[0] - 1, columns + shift[1] - 1
        at = np.ravel_multi_index(cells, blocks.shape, "wrap" if boundary == "periodic" else "clip")
        np.maximum.at(ends.reshape(-1), at, blocks[rows, columns])
    edge, own = _largest(bent, ends, count), _largest(bends, blocks, count)
    allowed = np.where(own <= _SMOOTH * edge, _OPENING * edge, 0.0)[ends]
    parts, count = label_parts(~contact & (allowed > 0), boundary, 4)
    closes = _largest(gap > allowed, parts, count) == 0
    counted: Mask = contact | (closes[parts] & (parts > 0))
    return counted


def _largest(field: Array | Mask, labels: Labels, count: int) -> Array:
    """Return the largest value of a field that is not negative in the cells of each label."""
    largest, cells = np.zeros(count + 1), np.nonzero(labels)
    np.maximum.at(largest, labels[cells], field[cells])
    return largest


def _bend(field: Array, axis: int, boundary: Boundary) -> Array:
    """Return the second differences along an axis, of shape (nx, ny); NaN at a free edge."""
    bend = np.empty(field.shape)
    along, of = (np.moveaxis(array, axis, 0) for array in (field, bend))
    with np.errstate(invalid="ignore"):
        np.add(along[:-2], along[2:], out=of[1:-1])
        if boundary == "periodic":
            of[0], of[-1] = along[-1] + along[1 % len(along)], along[-2 % len(along)] + along[0]
        else:
            of[[0, -1]] = np.nan
        bend -= 2 * field
    return bend


def _erode(mask: Mask, axis: int, boundary: Boundary) -> Mask:
    """Return the cells of a mask whose neighbours along an axis are of it, too, if there are."""
    before, after = np.roll(mask, 1, axis), np.roll(mask, -1, axis)
    if boundary == "free":
        np.moveaxis(before, axis, 0)[0] = np.moveaxis(after, axis, 0)[-1] = True
    return mask & before & after
