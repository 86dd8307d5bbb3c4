"""The edge of a contact under an attraction, which moves by what the tractions beside it miss.

A front that moves by v changes the tractions by v times their slope across it.  Tractions r that
are missed push it inwards with the force f = ∫ (dg/dn) r dn per length, across the zone in which
the law acts.  A wave κ along it resists with a stiffness cw|κ|, w being the work of adhesion: the
energy release rate at the edge of a crack of small waves v differs by −w|κ|v (Rice 1985), so c = 1
on a half-space; on a membrane, where the slope at the edge falls by |κ|v of itself, c = 2; where
the stiffness goes as q^α, c = α.

That stiffness is found on the plane: the solution V of (c/2) w (−∇² + 1/ℓ²) V = (dg/dn) r, the
potential of charges on the front, is there f / (cw √(κ² + 1/ℓ²)).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import scipy.fft

from pellicle import Grid
from pellicle.analysis import perimeter
from pellicle.arrays import Array, Mask
from pellicle.contact import Adhesive

from .preconditioner import edges

# c, for all kernels.
STIFFNESS: Final = 1.25
# ℓ over the mean extent of the contact, its area over its perimeter. As a whole a front has the
# stiffness cw/ℓ: 5w/a on a disc of radius a, as an unloaded contact after Johnson et al. (1971) has
# at a fixed depth.
LONGEST: Final = 0.5
# A front moves in a round by at most this many cells, or as far as estimated without the gain if
# that is more, up to this share of the mean extent of the contact; beyond, the linear estimate says
# nothing. A gain from a contact that is not settled would carry the front of a paraboloid with 512
# points on by thousands of cells.
_MOST_CELLS: Final = 3.0
_MOST_SHARE: Final = 0.3


@dataclass(frozen=True)
class Front:
    """The edge of a contact, and the zone beside it."""

    problem: Adhesive
    contact: Mask
    gap: Array
    """[m]; infinite where there is no indenter."""
    law_traction: Array
    """Traction that the law exerts across it [Pa]."""

    @cached_property
    def length(self) -> float:
        """Perimeter of the contact [m]."""
        return float(perimeter(self.contact, self.problem.grid))

    @cached_property
    def extent(self) -> float:
        """Area of the contact over its perimeter [m]."""
        grid = self.problem.grid
        return np.count_nonzero(self.contact) * grid.cell_area / self.length

    def _shift(self, zone: Mask, missed: Array, gain: float) -> Array:
        """Return how far the front recedes, at each cell [m], times a factor and limited."""
        law, grid = self.problem.law, self.problem.grid
        gap = np.clip(np.where(self.contact, 0.0, self.gap), 0.0, 2 * law.cutoff())
        push = np.where(zone, slope(gap, grid), 0.0) * missed
        estimate = potential(push, law.work_of_adhesion(), LONGEST * self.extent, grid)
        few_cells = _MOST_CELLS * max(edges(grid))
        limit = np.clip(np.abs(estimate), few_cells, max(few_cells, _MOST_SHARE * self.extent))
        return np.clip(gain * estimate, -limit, limit)

    def move_front(self, traction: Array, missed: Array, gain: float) -> tuple[Array, Mask]:
        """Return tractions [Pa] and contact after the front has moved by what is ``missed``."""
        from scipy.ndimage import distance_transform_edt

        grid, contact = self.problem.grid, self.contact
        zone = ((self.law_traction < 0) | (missed != 0)) & ~contact
        shift = self._shift(zone, missed, gain)
        steep = np.where(zone, slope(self.law_traction, grid), 0.0)
        following = traction + steep * shift
        greatest = float(np.abs(shift).max(where=zone, initial=0.0))
        # The slope of the zone is continued into the contact and beyond the zone.
        for inside, side in ((contact, -1.0), (~(contact | zone), 1.0)):
            distance, (i, j) = distance_transform_edt(
                inside, sampling=grid.spacing, return_indices=True
            )
            ring = inside & (distance <= greatest)
            i, j = i[ring], j[ring]
            following[ring] = traction[i, j] + steep[i, j] * (shift[i, j] + side * distance[ring])
        moved = shifted_contact(contact, shift, grid)
        moved &= np.isfinite(self.problem.profile)
        return following, moved


def potential(push: Array, work: float, longest: float, grid: Grid) -> Array:
    """Return V [m] for a push [Pa] of each cell, a work of adhesion [J/m²] and ℓ [m]."""
    qx, qy = grid.wavenumbers()
    stiffness = 0.5 * STIFFNESS * work * (qx**2 + qy**2 + 1 / longest**2)
    return np.asarray(scipy.fft.irfft2(scipy.fft.rfft2(push) / stiffness, s=grid.shape))


def shifted_contact(contact: Mask, shift: Array, grid: Grid) -> Mask:
    """Return the contact after its edge has moved into it by ``shift`` [m], or out of it if < 0.

    The edge lies half a cell from the cells on both sides. A cell leaves if it has passed the cell
    by as much, and joins as soon as it is reached: of a cell that joins too late the gap closes,
    but one that leaves too late is pulled out by its wall pressure.
    """
    from scipy.ndimage import distance_transform_edt

    half = 0.5 * max(edges(grid))
    inside, outside = (
        distance_transform_edt(mask, sampling=grid.spacing) for mask in (contact, ~contact)
    )
    shifted: Mask = np.where(contact, shift <= inside + half, -shift > outside - half)
    return shifted


def slope(values: Array, grid: Grid) -> Array:
    """Return the magnitude of the gradient, from central differences."""
    slopes: Array = np.zeros(values.shape)
    for axis, width in enumerate(edges(grid)):
        if values.shape[axis] > 1:
            slopes += np.square(np.gradient(values, width, axis=axis))
    return np.asarray(np.sqrt(slopes))
