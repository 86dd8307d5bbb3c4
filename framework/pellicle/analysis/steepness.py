"""Slopes of indenter and surface, which the theory takes as small."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.grid import Grid
from pellicle.surface.convolution import blocks

# Cells in a block of rows, few enough for its slopes to take no memory to speak of.
_BLOCK = 2**13


def steepest(profile: Array, contact: Mask, grid: Grid) -> float:
    """Return the largest slope of an indenter in contact, in any direction.

    It is the largest gradient between four cells in contact that meet in a corner, or slope between
    two neighbours if that is larger, as on the ridge of a roof or in a contact one cell wide. The
    ``profile`` [m] and ``contact``, bool, have the grid's shape.
    """
    largest = 0.0
    for block in blocks(contact.shape[0], max(1, _BLOCK // contact.shape[1])):
        # With the first row of the next block, so that no slope between two is left out.
        rows = slice(block.start, block.stop + 1)
        heights = np.where(contact[rows], profile[rows], np.nan)
        by_x, by_y = (np.diff(heights, axis=n) / width for n, width in enumerate(grid.spacing))
        at_corners = 0.5 * np.hypot(by_x[:, 1:] + by_x[:, :-1], by_y[1:] + by_y[:-1])
        for slopes in (np.abs(by_x), np.abs(by_y), at_corners):
            largest = float(np.fmax.reduce(slopes, axis=None, initial=largest))
    return largest
