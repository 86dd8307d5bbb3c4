"""The traction of a law on the cells of a grid, averaged over each where the law asks for it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from pellicle.arrays import Array, Cells, Mask
from pellicle.grid import Boundary

from .law import Law
from .masks import dilate, label_parts

# Weights of a cell, its two neighbours and the one across the corner at the middle of a quarter of
# the cell, where the gap is interpolated bilinearly.
_WEIGHTS: Final = np.array([9.0, 3.0, 3.0, 1.0]) / 16
_QUARTERS: Final = ((-1, -1), (-1, 1), (1, -1), (1, 1))
# Heights of neighbours that differ by more than this multiple of the cutoff are a step, across
# which the gap is not interpolated.
_STEP: Final = 4.0


@dataclass(frozen=True)
class Attraction:
    """The traction that a law exerts across a gap, and its energy per cell.

    The energy is a sum over points at which the gap is interpolated from the cells, and the
    traction is the exact derivative of that sum by the gap of each cell.
    """

    law: Law
    contact: Mask
    closed_cells: Mask
    """Cells whose traction no gap reduces."""
    inner: Mask
    """Cells of `closed_cells` without points, whose energy is that of a closed gap."""
    cells: Cells
    """Flat indices of the cells to which a point belongs, (corner, point)."""
    weights: Array
    """Weight of each corner in the gap of a point, (corner,)."""
    gap: Array
    """Gap at the points [m], (point,)."""
    share: float
    """Area of a point over that of a cell."""

    @cached_property
    def traction(self) -> Array:
        """Traction on each cell [Pa]; −(strength) within a contact."""
        traction = self._on_cells(self.law.traction(self.gap))
        traction[self.closed_cells] = -self.law.strength()
        return traction

    @property
    def energy(self) -> float:
        """Sum of the energies per area of all cells [J/m²]."""
        closed = np.count_nonzero(self.inner) * self.law.work_of_adhesion()
        return float(self.law.energy(self.gap).sum()) * self.share - closed

    @cached_property
    def greatest_slope(self) -> float:
        """The greatest dσ/dg at the points [Pa/m]."""
        return float(self._slope.max(initial=0.0))

    @cached_property
    def zone(self) -> Mask:
        """The cells off the contact whose traction follows the gap."""
        cells = self._on_cells((self._slope != 0).astype(float)) > 0
        return cells & ~self.contact

    def change(self, gap_change: Array) -> Array:
        """Return the change of the traction off the contact [Pa] for one of the gap there [m]."""
        change = _interpolated(np.where(self.contact, 0.0, gap_change), self.cells, self.weights)
        traction = self._on_cells(self._slope * change)
        traction[self.contact] = 0.0
        return traction

    @cached_property
    def _slope(self) -> Array:
        return self.law.slope(self.gap)

    def _on_cells(self, values: Array) -> Array:
        """Return the sum over the points of each cell, by their weights in the gap of the point."""
        sums = np.zeros(self.contact.size)
        # One corner at a time: where zones fill the domain, temporary arrays are large.
        for cells, weight in zip(self.cells, self.share * self.weights, strict=True):
            sums += np.bincount(cells, weight * values, minlength=sums.size)
        return sums.reshape(self.contact.shape)


def attraction(
    law: Law, profile: Array, gap: Array, contact: Mask, boundary: Boundary
) -> Attraction:
    """Return what a law exerts across ``gap`` [m], which counts as closed in contact.

    A law that is averaged acts at four points of each cell, between which and the middles of the
    cells the gap is bilinear: the edge of a zone lies within a cell then. It is not interpolated
    across steps of the ``profile`` [m] and beyond the indenter. A law that needs contact acts only
    on patches of cells within its cutoff that hold a contact.
    """
    near: Mask = contact | (gap < law.cutoff())
    if law.needs_contact:
        labels, number = label_parts(near, boundary, 4)
        joined = np.zeros(number + 1, dtype=bool)
        joined[labels[contact]] = True
        joined[0] = False
        near = joined[labels]
    gap = np.where(contact, 0.0, gap)
    if not law.averaged:
        cells = np.flatnonzero(near & ~contact)[None]
        values = gap.ravel()[cells[0]]
        return Attraction(law, contact, contact, contact, cells, np.ones(1), values, 1.0)
    closed = contact & ~dilate(~contact, boundary)
    inner = closed & ~dilate(~closed, boundary)
    acting = dilate(near, boundary) & np.isfinite(profile) & ~inner
    corners = np.concatenate(
        [_corners(acting, side, law, profile, boundary) for side in _QUARTERS], 1
    )
    values = _interpolated(gap, corners, _WEIGHTS)
    return Attraction(law, contact, closed, inner, corners, _WEIGHTS, values, 0.25)


def _interpolated(values: Array, cells: Cells, weights: Array) -> Array:
    at_points = np.zeros(cells.shape[1])
    for corners, weight in zip(cells, weights, strict=True):
        at_points += weight * values.ravel()[corners]
    return at_points


def _corners(
    acting: Mask, side: tuple[int, int], law: Law, profile: Array, boundary: Boundary
) -> Cells:
    """Return each cell, its neighbours to a ``side`` and the one across the corner, (4, cells).

    A cell stands for neighbours beyond a step, the last row for those beyond the domain.
    """
    (i, j), (nx, ny) = np.nonzero(acting), acting.shape
    beyond_i, beyond_j = i + side[0], j + side[1]
    if boundary == "periodic":
        beyond_i, beyond_j = beyond_i % nx, beyond_j % ny
    else:
        beyond_i, beyond_j = np.clip(beyond_i, 0, nx - 1), np.clip(beyond_j, 0, ny - 1)
    cell = i * ny + j
    corners = np.stack([cell, beyond_i * ny + j, i * ny + beyond_j, beyond_i * ny + beyond_j])
    heights = profile.ravel()
    step = np.abs(heights[corners] - heights[cell]) > _STEP * law.cutoff()
    return np.where(step, cell, corners)
