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
    bent = np.fmax.reduce(np.where(contact, -_bends(displacement, boundary), 0.0), initial=0.0)
    bends = np.abs(_bends(np.where(np.isfinite(heights), heights, np.nan), boundary))
    smooth = bends <= _SMOOTH * bent.max(initial=0.0)
    if contact.all() or not smooth.any():
        return contact
    from scipy.ndimage import maximum, maximum_filter, minimum_filter

    mode = "wrap" if boundary == "periodic" else "nearest"
    lines = (minimum_filter(smooth[axis], (1, 3)[:: 1 - 2 * axis], mode=mode) for axis in (0, 1))
    blocks, count = label_parts(np.logical_and(*lines), boundary, 8)
    ends, numbers = maximum_filter(blocks, 3, mode=mode), np.arange(1, count + 1)
    edge, own = (
        np.asarray(maximum(field, labels, numbers))
        for field, labels in ((bent, ends), (bends.max(axis=0), blocks))
    )
    allowed = np.append(0.0, np.where(own <= _SMOOTH * edge, _OPENING * edge, 0.0))[ends]
    parts, count = label_parts(~contact & (allowed > 0), boundary, 4)
    opens = np.append(True, maximum(gap > allowed, parts, np.arange(1, count + 1)))
    counted: Mask = contact | ~opens[parts]
    return counted


def _bends(field: Array, boundary: Boundary) -> Array:
    """Return the second differences along each axis, of shape (2, nx, ny); NaN at a free edge."""
    periodic = boundary == "periodic"
    padded = np.pad(field, 1, "wrap") if periodic else np.pad(field, 1, constant_values=np.nan)
    rows, columns = padded[:, 1:-1], padded[1:-1]
    with np.errstate(invalid="ignore"):
        return np.stack(
            [rows[:-2] - 2 * field + rows[2:], columns[:, :-2] - 2 * field + columns[:, 2:]]
        )
