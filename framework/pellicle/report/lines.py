"""Values along a line of cells: a smooth curve, and the cells at the edge of contact."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Array, Mask

EDGE_CELLS = "cells at the edge of contact"
"""Name of the cells whose pressure is that of the grid."""
_EDGE = 3
_RESOLVED = 16
_SMOOTH = 300


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


def smooth(x: Array, y: Array) -> tuple[Array, Array]:
    """Return a curve through points without their corners, with gaps where ``y`` is not finite.

    Cubic pieces (Fritsch & Butland 1984) do not overshoot. Curves of 300 points stay as they are.
    """
    if x.size >= _SMOOTH or np.any(np.diff(x) <= 0):
        return x, y
    from scipy.interpolate import PchipInterpolator

    pieces_x, pieces_y = [], []
    finite = np.flatnonzero(np.isfinite(y))
    for piece in np.split(finite, np.flatnonzero(np.diff(finite) > 1) + 1):
        if piece.size > 2:
            fine = np.interp(np.arange(0, piece.size - 0.95, 0.1), np.arange(piece.size), x[piece])
            pieces_x += [fine, fine[-1:]]
            pieces_y += [PchipInterpolator(x[piece], y[piece])(fine), np.full(1, np.nan)]
        else:
            pieces_x += [x[piece], x[piece][-1:]]
            pieces_y += [y[piece], np.full(piece[-1:].size, np.nan)]
    return np.concatenate(pieces_x), np.concatenate(pieces_y)
