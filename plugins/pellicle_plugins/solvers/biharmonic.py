"""Relaxation of an extension towards Δ²u = 0 beside the contact, and its exact transpose."""

from __future__ import annotations

from typing import Final

import numpy as np
import scipy.sparse
from numpy.typing import NDArray

from pellicle.arrays import Mask
from pellicle.contact import dilated
from pellicle.surface import row_blocks, shared

Field = NDArray[np.float32]

_SWEEPS: Final = 12
# Eigenvalues of Δ² for waves of about eight cells and of two, in units of the cell.
_SLOWEST, _FASTEST = 0.3, 64.0
# Roots of the Chebyshev polynomial, used from both ends in turn: in order, round-off would grow.
_ROOTS: Final = np.cos(np.pi * (np.arange(_SWEEPS) + 0.5) / _SWEEPS)
# Relaxation factors of the Chebyshev iteration on that range.
_DAMPINGS: Final = tuple(
    np.float32(2 / (_FASTEST + _SLOWEST + (_FASTEST - _SLOWEST) * root))
    for pair in zip(_ROOTS[: _SWEEPS // 2], _ROOTS[::-1], strict=False)
    for root in pair
)
# Cells are relaxed up to this many cells from the contact: beyond, interpolation is smooth enough,
# and sweeps over all cells save no operator application.
_NEAR: Final = 7
# Share of the cells above which sweeps over all of them are faster than a matrix of those to relax.
_DENSE: Final = 0.2


def sweeps_near(free: Field | Mask, stretch: tuple[float, float]) -> Sweeps:
    """Return Chebyshev sweeps that relax short waves beside a contact, and their transpose.

    Both change a field in its place. ``free`` is how far each cell may move, 0 on the contact and 1
    off it, periodic, of one or two axes; ``stretch`` is the aspect ratio, see `stretch_of`.
    """
    weight = np.where(dilated(free < 1, cells=_NEAR), free, np.float32(0))
    if np.count_nonzero(weight) > _DENSE * weight.size:
        return _DenseSweeps(weight, stretch)
    return _SparseSweeps(weight, stretch)


def stretch_of(dx: float, dy: float) -> tuple[float, float]:
    """Return (h/dx)² and (h/dy)², where h makes their sum 2."""
    ratio = (dx / dy) ** 2
    return 2 / (1 + ratio), 2 * ratio / (1 + ratio)


class _SparseSweeps:
    """Sweeps by a sparse matrix, on the cells of a ``weight`` above 0."""

    def __init__(self, weight: Field, stretch: tuple[float, float]) -> None:
        stencil = _stencil(weight.ndim, stretch)
        self._relaxed = np.flatnonzero(weight)
        number = self._relaxed.size
        place = np.unravel_index(self._relaxed, weight.shape)
        neighbours = np.empty((number, len(stencil)), dtype=np.int64)
        for column, offset in enumerate(stencil):
            moved = tuple(p + o for p, o in zip(place, offset, strict=True))
            neighbours[:, column] = np.ravel_multi_index(moved, weight.shape, mode="wrap")
        reached = np.zeros(weight.size, dtype=bool)
        reached[neighbours] = True
        reached[self._relaxed] = False
        # The cells to relax come first, then those that only their neighbours' change depends on.
        self._cells = np.concatenate([self._relaxed, np.flatnonzero(reached)])
        position = np.empty(weight.size, dtype=np.int32)
        position[self._cells] = np.arange(self._cells.size, dtype=np.int32)
        data = np.outer(weight.ravel()[self._relaxed], np.array(list(stencil.values()), np.float32))
        starts = np.arange(number + 1, dtype=np.int32) * np.int32(len(stencil))
        self._matrix = scipy.sparse.csr_array(
            (data.ravel(), position[neighbours].ravel(), starts), shape=(number, self._cells.size)
        )

    def apply(self, field: Field) -> None:
        values = field.ravel()[self._cells]
        relaxed = values[: self._relaxed.size]
        for damping in _DAMPINGS:
            relaxed -= damping * (self._matrix @ values)
        field.ravel()[self._relaxed] = relaxed

    def apply_transpose(self, field: Field) -> None:
        values = field.ravel()[self._cells]
        relaxed = values[: self._relaxed.size]
        for damping in reversed(_DAMPINGS):
            values -= self._matrix.T @ (damping * relaxed)
        field.ravel()[self._cells] = values


class _DenseSweeps:
    """Sweeps over all cells, each of which moves in proportion to its ``weight``."""

    def __init__(self, weight: Field, stretch: tuple[float, float]) -> None:
        self._weight, self._stretch = weight, stretch

    def apply(self, field: Field) -> None:
        for damping in _DAMPINGS:
            _subtract_biharmonic(field, field, damping, self._stretch, self._weight)

    def apply_transpose(self, field: Field) -> None:
        for damping in reversed(_DAMPINGS):
            _subtract_biharmonic(field, self._weight * field, damping, self._stretch)


Sweeps = _SparseSweeps | _DenseSweeps


def _stencil(axes: int, stretch: tuple[float, float]) -> dict[tuple[int, ...], float]:
    """Return the factors of h⁴ Δ² by the offset of the cell; its eigenvalues are at most 64."""
    if axes == 1:
        return {(-2,): 1, (-1,): -4, (0,): 6, (1,): -4, (2,): 1}
    x, y = stretch
    laplacian = {(0, 0): -4.0, (-1, 0): x, (1, 0): x, (0, -1): y, (0, 1): y}
    stencil: dict[tuple[int, ...], float] = {}
    for (i, j), a in laplacian.items():
        for (k, m), b in laplacian.items():
            stencil[i + k, j + m] = stencil.get((i + k, j + m), 0.0) + a * b
    return stencil


def _subtract_biharmonic(
    target: Field,
    field: Field,
    damping: np.float32,
    stretch: tuple[float, float],
    weight: Field | None = None,
) -> None:
    """Subtract ``damping`` × ``weight`` × h⁴ Δ² of ``field`` from ``target``."""
    wide = wrapped(field, 2)

    def subtract(rows: slice) -> None:
        change = _laplacian(_laplacian(wide[rows.start : rows.stop + 4], stretch), stretch)
        change *= damping
        if weight is not None:
            change *= weight[rows]
        target[rows] -= change

    shared(subtract, row_blocks(field.shape))


def _laplacian(wide: Field, stretch: tuple[float, float]) -> Field:
    """Return h² Δ without the cells at the ends of each axis."""
    if wide.ndim == 1:
        change = np.float32(-2) * wide[1:-1]
        change += wide[:-2]
        change += wide[2:]
        return change
    x, y = stretch
    change = np.float32(-4 / x) * wide[1:-1, 1:-1]
    change += wide[:-2, 1:-1]
    change += wide[2:, 1:-1]
    if x != y:
        change *= np.float32(x / y)
    change += wide[1:-1, :-2]
    change += wide[1:-1, 2:]
    if y != 1:
        change *= np.float32(y)
    return change


def wrapped(field: Field, width: int = 1) -> Field:
    """Return a periodic field padded by ``width`` cells at both ends of each axis."""
    wide = np.empty([n + 2 * width for n in field.shape], field.dtype)
    inner = wide[width:-width] if field.ndim == 1 else wide[width:-width, width:-width]

    def copy(rows: slice) -> None:
        inner[rows] = field[rows]

    shared(copy, row_blocks(field.shape))
    for axis in range(field.ndim):
        lines = np.moveaxis(wide, axis, 0)
        lines[:width] = lines[-2 * width : -width]
        lines[-width:] = lines[width : 2 * width]
    return wide
