"""Flats of an indenter, which touch as a whole although some of their cells open.

Under tension the rim of a flat end carries a line load, which square cells follow in steps.  Cells
within then open by up to 0.08 of what the surface falls in the cell beside the rim (s/a = 0.03 to
100, 33 to 257 points), an opening that halves with the cell.  In the continuum the lowest flat
touches everywhere: −τ₀∇²u + (E*/2)|q|u would be positive, not 0, where u is highest.
"""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Array, Mask

_OPENING = 0.15
"""Opening of a flat, over what the surface falls beside it in a cell, that may be the cells'."""
_ROUNDING = 1e-14
"""Difference of two heights that are one, over the largest displacement."""


def with_flats(contact: Mask, heights: Array, gap: Array, displacement: Array) -> Mask:
    """Return the contact, bool, with all cells of a flat that touches and opens no further.

    A flat is made of 2 × 2 cells of one height [m] that have cells in common.  All arrays have the
    grid's shape (nx, ny), gap and displacement in m.
    """
    rounding = _ROUNDING * float(np.abs(displacement).max())
    finite = np.where(np.isfinite(heights), heights, np.nan)
    across, along = (np.abs(np.diff(finite, axis=axis)) <= rounding for axis in (0, 1))
    level = across[:, 1:] & across[:, :-1] & along[1:] & along[:-1]
    if not (level.any() and contact.any()):
        return contact
    from scipy.ndimage import label, maximum, minimum_filter

    # Blocks that touch in a corner have a cell in common, and so the same height.
    blocks, count = label(level, np.ones((3, 3)))
    flats = np.zeros(contact.shape, dtype=blocks.dtype)
    for rows in (np.s_[:-1], np.s_[1:]):
        for columns in (np.s_[:-1], np.s_[1:]):
            np.maximum(flats[rows, columns], blocks, out=flats[rows, columns])
    fall = displacement - minimum_filter(displacement, 3)
    touches, opening, falls = (
        np.asarray(maximum(field, flats, np.arange(1, count + 1))) for field in (contact, gap, fall)
    )
    whole = np.append(False, touches.astype(bool) & (opening <= _OPENING * falls))
    counted: Mask = contact | whole[flats]
    return counted
