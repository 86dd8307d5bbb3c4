"""The length of the border of a contact."""

from __future__ import annotations

from math import atan2, hypot, pi

import numpy as np
from numpy.typing import ArrayLike

from pellicle.grid import Grid


def perimeter(contact: ArrayLike, grid: Grid) -> float:
    """Return the length of the border of a contact [m].

    It is computed from the number of switches between contact and no contact along the two axes and
    the two diagonals of the cells (Cauchy–Crofton; Legland, Kiêu & Devaux 2007). For an isotropic
    border, such as that of a disc, it is right on average; for a straight border on square cells it
    is at most 5.2 % too short (along an axis) or 2.6 % too long. The total length of cell edges
    between contact and no contact would be 27 % too long for a disc; it is returned on a grid one
    cell across, where borders are parallel to an axis.

    On a free boundary the edge of the domain counts as border where there is contact; on a periodic
    one it does not. ``contact`` is bool, of shape (nx, ny).
    """
    inside = np.asarray(contact, dtype=bool)
    if grid.boundary == "free":
        inside = np.pad(inside, 1)
    dx, dy = grid.spacing

    def switches(step: tuple[int, int]) -> int:
        """Return the number of switches of contact between cells and those one step away."""
        # A contact on a free boundary has been padded, so it can be treated as periodic.
        return int(np.count_nonzero(inside != np.roll(inside, step, (0, 1))))

    if 1 in grid.shape:
        return dy * switches((1, 0)) + dx * switches((0, 1))
    slope = atan2(dy, dx)
    across = dx * dy / hypot(dx, dy)
    # Step to the next cell; distance between parallel lines; angle represented by the direction.
    directions = (
        ((1, 0), dy, slope),
        ((0, 1), dx, pi / 2 - slope),
        ((1, 1), across, pi / 4),
        ((1, -1), across, pi / 4),
    )
    return sum(angle * between * switches(step) / 2 for step, between, angle in directions)
