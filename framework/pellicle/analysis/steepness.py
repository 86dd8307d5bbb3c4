"""Slopes of indenter and surface, which the theory takes as small."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.contact.equilibrium import Equilibrium
from pellicle.grid import Grid
from pellicle.surface.sharing import blocks

# Relative change of G(q) q² over a decade below which it is the limit of short waves.
_CONSTANT = 0.05
# Cells in a block of rows, few enough for its slopes to take no memory to speak of.
_BLOCK = 2**13


def steepest(profile: Array, contact: Mask, grid: Grid) -> float:
    """Return the largest slope of an indenter in contact, in any direction.

    It is the largest gradient between four cells in contact that meet in a corner, or slope between
    two neighbours if that is larger, as on the ridge of a roof or in a contact one cell wide.

    Parameters
    ----------
    profile
        Heights [m] of the grid's shape.
    contact
        Bool, of the same shape.
    grid
        The cells.
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


def rim_slope(compliance: Callable[[Array], Array], equilibrium: Equilibrium) -> float:
    """Return the slope √(2w/τ₀) of the surface at the rim of an adhesive contact; 0 without τ₀.

    With a surface tension τ₀ the energy per area w that is released bends the surface by this angle
    (Young–Dupré at small slopes). The tension is the limit of 1/(G q²) for short waves; without one
    the slope of the theory has no bound, and depends on the range of the interaction.
    """
    law = equilibrium.problem.law
    if law is None:
        return 0.0
    q = 1e3 * np.pi / min(equilibrium.problem.grid.spacing) * np.array([1.0, 10.0])
    a, b = compliance(q) * q**2
    if not abs(b / a - 1) < _CONSTANT:
        return 0.0
    return float(np.sqrt(2 * law.work_of_adhesion() * b))
