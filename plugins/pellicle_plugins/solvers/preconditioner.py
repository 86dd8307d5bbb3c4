"""An approximate inverse of the operator restricted to the contact: Eᵀ K E."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from typing import Final

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from pellicle.arrays import Array, Mask
from pellicle.grid import Grid
from pellicle.numerics.operators import Operator

from .circulant_stiffness import Field, Stiffness
from .multilevel_extension import Extension, bends, stretch_of

Cells = NDArray[np.int64]

# Without a margin, contact at the edge of a free domain couples across it.
_FREE_MARGIN: Final = 1.25
# A row of cells this many times as long across as along yields as in plane strain.
_SLENDER: Final = 8
# The extension's plane is rounded up to what can be halved as often as this.
_HALVINGS: Final = 6


class Preconditioner:
    """K, and what else of Eᵀ K E does not depend on the contact.

    ⟨A_cc⁻¹ v, v⟩ is the least ⟨k(q) w, w⟩ of all extensions w of v to the plane. E makes a smooth
    one, which is nearly the least, and K multiplies by the stiffness k(q) = 1/G(q).
    """

    def __init__(self, operator: Operator) -> None:
        grid = operator.grid
        self._operator = operator
        self._shape = grid.shape
        # The transform's shape, and that of the extension, whose pyramid needs even numbers.
        if grid.boundary == "periodic":
            self._plane = grid.shape
            self._padded = _round_up(grid.shape)
        else:
            self._plane = self._padded = _free_shape(grid)
        self._stiffness = Stiffness(operator, self._plane)
        levels = _levels(self._padded)
        orders = _stiffness_orders(operator, levels + 1)
        self.bends = bends(orders[0])
        # A plate bends all the way from one contact to the next. Elsewhere, and towards the edge of
        # a free domain, what is far from all contact is better left at rest.
        joins = self.bends and grid.boundary == "periodic"
        self._orders = orders[: levels if joins else min(levels, _HALVINGS)]
        self._stretch = stretch_of(*edges(grid))

    @property
    def stiffest(self) -> float:
        """Stiffness of the stiffest wave [Pa/m]."""
        return self._stiffness.greatest

    @cached_property
    def settling(self) -> Stiffness:
        """K on the grid itself as if it were periodic; see `relaxed`."""
        here = self._plane == self._shape
        return self._stiffness if here else Stiffness(self._operator, self._shape)

    def on(self, contact: Mask) -> OnContact:
        """Return Eᵀ K E on ``contact``, bool of the grid's shape."""
        cells = np.flatnonzero(contact)
        places, copied = cells, np.empty(0, dtype=np.int64)
        if self._padded != self._shape:
            places, copied = self._on_the_plane(cells)
        known = np.zeros(self._padded, dtype=bool)
        known.ravel()[places] = True
        return OnContact(
            contact=contact,
            cells=cells,
            places=places,
            copied=copied,
            extension=Extension(known, self._orders, self._stretch),
            stiffen=self._stiffen,
            bends=self.bends,
        )

    def _on_the_plane(self, cells: Cells) -> tuple[Cells, Cells]:
        """Return the flat indices of ``cells`` and of their copies on the extension's plane.

        The second array says of which cell each copy is.
        """
        (nx, ny), (px, py) = self._shape, self._padded
        i, j = np.divmod(cells, ny)
        places = i * py + j
        copies, copied = [places], [np.empty(0, dtype=np.int64)]
        if self._plane == self._shape:
            # Beyond its period a periodic field goes on with its first cells.
            for down, right in ((nx, 0), (0, ny), (nx, ny)):
                here = np.flatnonzero((i + down < px) & (j + right < py))
                copied.append(here)
                copies.append(places[here] + down * py + right)
        return np.concatenate(copies), np.concatenate(copied)

    def _stiffen(self, field: Field) -> Field:
        """Return K applied to a field on the extension's plane; what is beyond the period is 0."""
        mx, my = self._plane
        force = self._stiffness(field[:mx, :my])
        if self._padded == self._plane:
            return force
        padded = np.zeros(self._padded, dtype=np.float32)
        padded[:mx, :my] = force
        return padded


class OnContact:
    """Eᵀ K E on one contact, in single precision, from and to its cells."""

    def __init__(
        self,
        contact: Mask,
        cells: Cells,
        places: Cells,
        copied: Cells,
        extension: Extension,
        stiffen: Callable[[Field], Field],
        bends: bool,
    ) -> None:
        self.contact = contact
        """Bool of the grid's shape."""
        self.cells = cells
        """Flat index of each cell of the contact on the grid."""
        self.bends = bends
        """Whether bending decides at the size of a cell."""
        self._places = places
        self._copied = copied
        self._extension = extension
        self._stiffen = stiffen
        self._given = np.zeros(extension.shape, dtype=np.float32)

    def __call__(self, residual: Array | Field) -> Array:
        """Return the preconditioned residual; both have one value for each cell of `cells`."""
        # A power of two changes no digit, and keeps small residuals in single precision.
        size = 2.0 ** math.frexp(float(np.abs(residual).max()))[1]
        return self._gathered(self._stiffen(self._spread(residual / size))) * size

    def extended(self, values: Array | Field) -> Field:
        """Return E of one value for each cell of `cells`; of the grid's shape."""
        nx, ny = self.contact.shape
        return self._spread(values)[:nx, :ny]

    def moved(self, forces: Array) -> Array:
        """Return forces [Pa] of the grid's shape with those off the contact moved onto it by Eᵀ.

        Eᵀ K is the inverse of the operator on the contact but for the square of what E lacks, so
        that forces which make a displacement that touches on the contact are moved to nearly those
        that close it.
        """
        off = (forces != 0) & ~self.contact
        moved = forces.copy()
        moved[off] = 0
        if off.any() and self.cells.size:
            nx, ny = forces.shape
            size = max(forces.max(where=off, initial=0.0), -forces.min(where=off, initial=0.0))
            field = np.zeros(self._extension.shape, dtype=np.float32)
            np.divide(forces, size, out=field[:nx, :ny], where=off, casting="same_kind")
            moved.ravel()[self.cells] += self._gathered(field) * size
        return moved

    def _spread(self, values: Array | Field) -> Field:
        number, given = self.cells.size, self._given.ravel()
        given[self._places[:number]] = values
        given[self._places[number:]] = values[self._copied]
        return self._extension.spread(self._given)

    def _gathered(self, force: Field) -> Array:
        """Return Eᵀ applied to a field, for each cell of `cells`."""
        number, copied = self.cells.size, self._copied
        gathered = self._extension.gather(force).ravel()[self._places]
        there = gathered.astype(np.float64)
        np.add.at(there[:number], copied, there[number:])
        return there[:number]


def _free_shape(grid: Grid) -> tuple[int, int]:
    """Return the cells of the plane of E on a free boundary, those of a margin included."""
    multiple = 2**_HALVINGS
    lengths = grid.spacing
    nx, ny = (
        1
        if n == 1 and across > _SLENDER * along
        else multiple * scipy.fft.next_fast_len(int(np.ceil(_FREE_MARGIN * n / multiple)))
        for n, across, along in zip(grid.shape, lengths, lengths[::-1], strict=True)
    )
    return nx, ny


def _round_up(shape: tuple[int, int]) -> tuple[int, int]:
    """Return the shape, rounded up along each axis of more than one cell to what can be halved."""
    fewest = min((n for n in shape if n > 1), default=1)
    multiple = 2 ** min(_HALVINGS, max(0, fewest.bit_length() - 2))
    nx, ny = (-(-n // multiple) * multiple if n > 1 else 1 for n in shape)
    return nx, ny


def _levels(shape: tuple[int, int]) -> int:
    """Return how many levels the extension has: halvings that leave whole cells, two or more."""
    halved = [n for n in shape if n > 1]
    levels = 0
    while halved and all(n >= 4 and n % 2 == 0 for n in halved):
        halved = [n // 2 for n in halved]
        levels += 1
    return levels


def edges(grid: Grid) -> tuple[float, float]:
    """Return dx and dy [m]; along an axis of one cell, which has no waves, that of the other."""
    (nx, ny), (dx, dy) = grid.shape, grid.spacing
    return (dx if nx > 1 else dy, dy if ny > 1 else dx)


def _stiffness_orders(operator: Operator, levels: int) -> list[float]:
    """Return α ≥ 0, the stiffness being k ~ q^α at the cells of each level, the finest first."""
    q = np.pi / max(edges(operator.grid)) * 0.5 ** np.arange(levels + 1, dtype=np.float64)
    stiffness = 1 / operator.compliance(q)
    return [max(0.0, float(order)) for order in -np.diff(np.log2(stiffness))]
