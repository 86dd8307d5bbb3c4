"""Eᵀ K E, an approximate inverse of the operator restricted to the contact."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
import scipy.fft

from pellicle import Grid
from pellicle.arrays import Array, Cells, Mask
from pellicle.surface import Operator, convolve

from .biharmonic import Field, stretch_of
from .multilevel_extension import Extension, bends

# Without a margin, contact at the edge of a free domain couples to the opposite edge.
_FREE_MARGIN: Final = 1.25
# Width across a line of cells, over their length along it, above which strain is plane.
_SLENDER: Final = 8
# Share of an earlier lift on the cells of a contact from which on it serves there.
_RETAINED: Final = 0.9
# The extension's plane is rounded up to a size that can be halved this many times, and on grids of
# 4096 cells and more as often as leaves _COARSEST cells; six halvings took 29 applications there in
# place of 23, and 44 at 8192, as waves between distant contacts were not extended.
_HALVINGS: Final = 6
_COARSEST: Final = 32


class CirculantStiffness:
    """K, the multiplication by k(q) = 1/G(q) over its greatest value, in single precision.

    The periodic plane has ``shape`` cells of the size of those of ``operator``.
    """

    def __init__(self, operator: Operator, shape: tuple[int, int]) -> None:
        dx, dy = operator.grid.spacing
        plane = Grid(points=shape, size=(shape[0] * dx, shape[1] * dy), boundary="periodic")
        waves = np.array(np.broadcast_arrays(*plane.wavenumbers()))
        # At q = 0 half of the stiffness of the longest wave keeps K positive definite.
        waves[int(np.argmax(plane.size)), 0, 0] = 2 * np.pi / max(plane.size)
        stiffness = 1 / operator.symbol(*waves)
        stiffness[0, 0] /= 2
        self.shape = shape
        self._workspace = operator.workspace
        self.greatest = float(stiffness.max())
        """The stiffness of the stiffest wave [Pa/m]."""
        self._symbol = np.asarray(stiffness / self.greatest, dtype=np.float32)

    def __call__(self, field: Field, out: Field | None = None) -> Field:
        """Return K applied to a field, in ``out``, which may be ``field``, or a new array.

        For a field in m the pressure is `greatest` times this.
        """
        return convolve(field, self._symbol, self.shape, self._workspace, out)


class Preconditioner:
    """K, and all other parts of Eᵀ K E that do not depend on the contact.

    ⟨A_cc⁻¹ v, v⟩ is the minimum of ⟨k(q) w, w⟩ over all extensions w of v to the plane. E makes a
    smooth extension, which is nearly the minimiser; K multiplies by the stiffness k(q) = 1/G(q).
    """

    def __init__(self, operator: Operator) -> None:
        self._operator = operator
        self._shape = operator.grid.shape
        scale, parts = operator.cache.get(Preconditioner, (None, None))
        if parts is None or scale != operator.greatest:
            parts = _Parts.of(operator)
            operator.keep(Preconditioner, (operator.greatest, parts))
        self._plane, self._padded = parts.plane, parts.padded
        self._stiffness = parts.stiffness
        self.stiffest = self._stiffness.greatest
        """Stiffness of the stiffest wave [Pa/m]."""
        self.bends = bends(parts.order)
        """Whether bending dominates the stiffness at the size of a cell."""
        self._orders, self._stretch = parts.orders, parts.stretch
        self._lift = np.zeros(self._shape, dtype=np.float32)

    def lift(self, on_contact: OnContact) -> Array:
        """Return a pressure on the cells of a contact, of sum 1, that nearly lifts it uniformly.

        It is the preconditioned uniform displacement. That of an earlier contact serves again while
        its cells that remain bear nearly all of it.
        """
        cells = on_contact.cells
        lift = self._lift.ravel()[cells].astype(np.float64)
        if lift.sum() < _RETAINED:
            lift = on_contact(np.ones(cells.size)).astype(np.float64)
            self._lift = np.zeros(self._shape, dtype=np.float32)
            np.put(self._lift, cells, lift / lift.sum())
        lift /= lift.sum()
        return lift

    @cached_property
    def column(self) -> Array:
        """Displacement [m] of all cells under 1 Pa on the first one: one operator application."""
        unit = np.zeros(self._shape)
        unit[0, 0] = 1
        return self._operator(unit)

    def stiffness(self, shape: tuple[int, int]) -> CirculantStiffness:
        """Return K on a periodic plane of as many cells of the grid's size."""
        is_plane = shape == self._plane
        return self._stiffness if is_plane else CirculantStiffness(self._operator, shape)

    def on(self, contact: Mask) -> OnContact:
        """Return Eᵀ K E on ``contact``, bool of the grid's shape."""
        return OnContact(self, contact)

    def _on_the_plane(self, cells: Cells) -> tuple[Cells, Cells]:
        """Return flat indices on the extension's plane of ``cells``, followed by their copies.

        The second array has the position in ``cells`` of the source of each copy.
        """
        nowhere = np.empty(0, dtype=np.int64)
        if self._padded == self._shape:
            return cells, nowhere
        (nx, ny), (px, py) = self._shape, self._padded
        i, j = np.divmod(cells, ny)
        indices = i * py + j
        copies, sources = [indices], [nowhere]
        if self._plane == self._shape:
            # Beyond the period the first cells are repeated.
            for down, right in ((nx, 0), (0, ny), (nx, ny)):
                repeated = np.flatnonzero((i + down < px) & (j + right < py))
                sources.append(repeated)
                copies.append(indices[repeated] + down * py + right)
        return np.concatenate(copies), np.concatenate(sources)


class _Parts(NamedTuple):
    """What the preconditioner of an operator consists of, made once for all load steps."""

    plane: tuple[int, int]
    """Shape of the transform."""
    padded: tuple[int, int]
    """Shape of the extension, whose pyramid needs even numbers."""
    stiffness: CirculantStiffness
    order: float
    """Power of q with which the stiffness grows at the size of a cell."""
    orders: list[float]
    """The same at the cell size of each level of the extension, the finest first."""
    stretch: tuple[float, float]

    @classmethod
    def of(cls, operator: Operator) -> _Parts:
        grid = operator.grid
        if grid.boundary == "periodic":
            plane, padded = grid.shape, _round_up(grid.shape)
        else:
            plane = padded = _free_shape(grid)
        # How often the plane can be halved, leaving two or more whole cells per axis.
        levels, halved = 0, [n for n in padded if n > 1]
        while halved and all(n >= 4 and n % 2 == 0 for n in halved):
            levels, halved = levels + 1, [n // 2 for n in halved]
        orders = operator.orders(levels + 1)
        # A plate bends all the way from one contact to the next. On other surfaces, and near the
        # edge of a free domain, an extension by 0 far from all contact is better.
        all_levels = bends(orders[0]) and grid.boundary == "periodic"
        used = orders[: levels if all_levels else min(levels, _halvings(grid.shape))]
        stiffness, stretch = CirculantStiffness(operator, plane), stretch_of(*edges(grid))
        return cls(plane, padded, stiffness, orders[0], used, stretch)


class OnContact:
    """Eᵀ K E on one contact, in single precision; a map between values on its cells."""

    def __init__(self, preconditioner: Preconditioner, contact: Mask) -> None:
        self.preconditioner = preconditioner
        self.contact = contact
        """Bool of the grid's shape."""
        self.cells = np.flatnonzero(contact)
        """Flat indices of the cells of the contact on the grid."""
        self._indices, self._sources = preconditioner._on_the_plane(self.cells)
        known = np.zeros(preconditioner._padded, dtype=bool)
        known.ravel()[self._indices] = True
        self._extension = Extension(known, preconditioner._orders, preconditioner._stretch)

    def __call__(self, residual: Array, mean: float = 0.0) -> Field:
        """Return the residual minus ``mean``, preconditioned; one value per cell of `cells`."""
        greatest = max(float(residual.max()) - mean, mean - float(residual.min()))
        # A power of two changes no digit, and keeps small residuals in single precision.
        size = 2.0 ** math.frexp(greatest)[1]
        field = self._apply((residual - mean) / size)
        mx, my = self.preconditioner._plane
        self.preconditioner._stiffness(field[:mx, :my], out=field[:mx, :my])
        # Beyond the period K gives nothing.
        field[mx:] = 0
        field[:, my:] = 0
        direction = self._apply_transpose(field)
        direction *= np.float32(size)
        return direction

    def extend(self, values: Array | Field) -> Field:
        """Return E applied to one value per cell of `cells`, on the grid."""
        nx, ny = self.contact.shape
        return self._apply(values)[:nx, :ny]

    def transfer(self, forces: Array, out: Array | None = None) -> Array:
        """Return forces [Pa] after transferring those off the contact onto it by Eᵀ.

        ``out`` is in C order and may be ``forces``.

        Eᵀ K is the inverse of the operator on the contact to second order in the error of E. So
        forces that displace the surface onto the indenter on the contact become nearly the
        pressure that closes the gap there.
        """
        off = np.flatnonzero((forces != 0) & ~self.contact)
        transferred = forces.copy() if out is None else out
        if not off.size:
            return transferred
        values = forces.ravel()[off]
        transferred.ravel()[off] = 0
        if self.cells.size:
            size = float(np.abs(values).max())
            field = np.zeros(self._extension.shape, dtype=np.float32)
            field[np.divmod(off, forces.shape[1])] = values / size
            transferred.ravel()[self.cells] += np.multiply(
                self._apply_transpose(field), size, dtype=np.float64
            )
        return transferred

    def _apply(self, values: Array | Field) -> Field:
        """Return E applied to one value for each cell of `cells`, on the extension's plane."""
        field = np.zeros(self._extension.shape, dtype=np.float32)
        number, flat = self.cells.size, field.ravel()
        flat[self._indices[:number]] = values
        flat[self._indices[number:]] = values[self._sources]
        del values
        return self._extension.apply(field)

    def _apply_transpose(self, force: Field) -> Field:
        """Return Eᵀ applied to a field, one value for each cell of `cells`."""
        number = self.cells.size
        values = self._extension.apply_transpose(force).ravel()[self._indices]
        np.add.at(values[:number], self._sources, values[number:])
        return values[:number]


def _free_shape(grid: Grid) -> tuple[int, int]:
    """Return the shape of the plane of E on a free boundary, including a margin."""
    multiple = 2 ** _halvings(grid.shape)
    lengths = grid.spacing
    nx, ny = (
        1
        if n == 1 and across > _SLENDER * along
        else multiple * scipy.fft.next_fast_len(int(np.ceil(_FREE_MARGIN * n / multiple)))
        for n, across, along in zip(grid.shape, lengths, lengths[::-1], strict=True)
    )
    return nx, ny


def _halvings(shape: tuple[int, int]) -> int:
    """Return how often the plane of the extension of a grid is to be halved."""
    return max(_HALVINGS, (_fewest(shape) // _COARSEST).bit_length() - 1)


def _round_up(shape: tuple[int, int]) -> tuple[int, int]:
    """Return the shape with axes of more than one cell rounded up to multiples of a power of 2."""
    multiple = 2 ** min(_halvings(shape), max(0, _fewest(shape).bit_length() - 2))
    nx, ny = (-(-n // multiple) * multiple if n > 1 else 1 for n in shape)
    return nx, ny


def _fewest(shape: tuple[int, int]) -> int:
    """Return the number of cells along the shorter axis, among those of more than one cell."""
    return min((n for n in shape if n > 1), default=1)


def edges(grid: Grid) -> tuple[float, float]:
    """Return dx and dy [m]; for an axis of one cell, which has no waves, that of the other axis."""
    (nx, ny), (dx, dy) = grid.shape, grid.spacing
    return (dx if nx > 1 else dy, dy if ny > 1 else dx)
