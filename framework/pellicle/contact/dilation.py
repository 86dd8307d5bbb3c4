"""Dilation of a set of cells by its neighbours, also across the edges of a periodic domain."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Mask
from pellicle.grid import Boundary


def dilated(mask: Mask, boundary: Boundary = "periodic", cells: int = 1) -> Mask:
    """Return the cells of ``mask`` and those up to ``cells`` away along each axis.

    Cells across a corner are neighbours too. The mask has one or more axes; `scipy.ndimage` has no
    dilation of a periodic one.
    """
    for axis in range(mask.ndim):
        reach = 0
        while reach < cells:
            # A longer shift would leave a hole beside the edge of a free domain.
            shift = min(reach + 1, cells - reach)
            before, after = np.roll(mask, shift, axis), np.roll(mask, -shift, axis)
            if boundary == "free":
                np.moveaxis(before, axis, 0)[:shift] = False
                np.moveaxis(after, axis, 0)[-shift:] = False
            mask = mask | before | after
            reach += shift
    return mask
