"""The cells at the edge of contact along a line."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Mask

EDGE_CELLS = "cells at the edge of contact"
"""Name of the cells whose pressure is that of the grid."""
_EDGE = 3
_RESOLVED = 16


def edge_cells(contact: Mask) -> Mask:
    """Return which cells along a line through one contact are its three outermost at each end.

    Their pressure depends on where the edge of contact passes through them, most where tension
    makes it jump there. Lines through several contacts or fewer than 16 cells have none.
    """
    edge = np.zeros(contact.shape, dtype=bool)
    (cells,) = np.nonzero(contact)
    if cells.size < _RESOLVED or cells[-1] - cells[0] + 1 != cells.size:
        return edge
    if cells[0] > 0:
        edge[cells[:_EDGE]] = True
    if cells[-1] < contact.size - 1:
        edge[cells[-_EDGE:]] = True
    return edge
