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

from .masks import label_parts

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
    bent = np.zeros(contact.shape)
    for axis in (0, 1):
        np.fmax(bent, -_bend(displacement, axis, boundary), out=bent, where=contact)
    smooth, bends = [], np.zeros(contact.shape)
    for axis in (0, 1):
        bend = np.abs(_bend(heights, axis, boundary))
        smooth.append(bend <= _SMOOTH * bent.max(initial=0.0))
        np.maximum(bends, bend, out=bends)
    del bend
    if contact.all() or not np.any(smooth):
        return contact
    from scipy.ndimage import maximum, maximum_filter, minimum_filter

    mode = "wrap" if boundary == "periodic" else "nearest"
    lines = (minimum_filter(smooth[axis], (1, 3)[:: 1 - 2 * axis], mode=mode) for axis in (0, 1))
    blocks, count = label_parts(np.logical_and(*lines), boundary, 8)
    ends, numbers = maximum_filter(blocks, 3, mode=mode), np.arange(1, count + 1)
    edge, own = (
        np.asarray(maximum(field, labels, numbers))
        for field, labels in ((bent, ends), (bends, blocks))
    )
    allowed = np.append(0.0, np.where(own <= _SMOOTH * edge, _OPENING * edge, 0.0))[ends]
    parts, count = label_parts(~contact & (allowed > 0), boundary, 4)
    opens = np.append(True, maximum(gap > allowed, parts, np.arange(1, count + 1)))
    counted: Mask = contact | ~opens[parts]
    return counted


def _bend(field: Array, axis: int, boundary: Boundary) -> Array:
    """Return the second differences along an axis, of shape (nx, ny); NaN at a free edge."""
    along = np.moveaxis(field, axis, 0)
    at = np.arange(len(along))
    with np.errstate(invalid="ignore"):
        bend = along[at - 1]
        bend += along[(at + 1) % at.size]
        bend -= along
        bend -= along
    if boundary != "periodic":
        bend[[0, -1]] = np.nan
    return np.moveaxis(bend, 0, axis)
