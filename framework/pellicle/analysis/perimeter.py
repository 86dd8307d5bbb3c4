"""The length of the border of a contact."""

from __future__ import annotations

from math import atan2, hypot, pi

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Mask
from pellicle.grid import Grid


def perimeter(contact: ArrayLike, grid: Grid) -> float:
    """Return the length of the border of a contact [m].

    It is counted from the switches between contact and no contact along the two axes and the two
    diagonals of the cells (Cauchy–Crofton; Legland, Kiêu & Devaux 2007). A border that runs in all
    directions alike, as that of a disc, is right in the mean; a straight one comes out at most
    5.2 % short (along an axis) or 2.6 % long, on square cells. The length of the cell edges
    between contact and no contact would be 27 % too long for a disc. On a grid one cell across,
    where borders run along the axes only, it is just that length.

    On a free boundary the edge of the domain is border where there is contact; on a periodic one
    it is not.

    Parameters
    ----------
    contact
        Bool, shape (nx, ny).
    grid
        The cells.
    """
    inside = np.asarray(contact, dtype=bool)
    if grid.boundary == "free":
        inside = np.pad(inside, 1)
    dx, dy = grid.spacing
    if 1 in grid.shape:
        edges = ((1, 0), dy), ((0, 1), dx)
        return sum(length * _switches(inside, step) for step, length in edges)
    slope = atan2(dy, dx)
    across = dx * dy / hypot(dx, dy)
    # Step to the next cell; distance between parallel lines; angle that the direction stands for.
    directions = (
        ((1, 0), dy, slope),
        ((0, 1), dx, pi / 2 - slope),
        ((1, 1), across, pi / 4),
        ((1, -1), across, pi / 4),
    )
    total = 0.0
    for step, between, angle in directions:
        total += angle * between * _switches(inside, step) / 2
    return total


def _switches(inside: Mask, step: tuple[int, int]) -> int:
    """Return how often contact begins or ends from a cell to the one that is a step away."""
    # What has no contact around it may be taken as periodic too.
    return int(np.count_nonzero(inside != np.roll(inside, step, (0, 1))))
