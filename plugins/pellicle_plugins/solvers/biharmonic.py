"""Relaxation of an extension towards Δ²u = 0 beside the contact, and its exact transpose."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Mask
from pellicle.contact import dilate
from pellicle.surface import in_threads, row_blocks

from .window import window

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
# Cells that Δ² reaches beyond those that are relaxed.
_REACH: Final = 2


def stretch_of(dx: float, dy: float) -> tuple[float, float]:
    """Return (h/dx)² and (h/dy)², where h makes their sum 2."""
    ratio = (dx / dy) ** 2
    return 2 / (1 + ratio), 2 * ratio / (1 + ratio)


class Sweeps:
    """Chebyshev sweeps that relax short waves beside a contact, and their transpose.

    Both change a field in its place. ``free`` is how far each cell may move, 0 on the contact and 1
    off it, periodic, of one or two axes; ``stretch`` is the aspect ratio, see `stretch_of`.
    """

    def __init__(self, free: Field | Mask, stretch: tuple[float, float]) -> None:
        weight = np.where(dilate(free < 1, cells=_NEAR), free, np.float32(0))
        self._window = window(weight > 0, _REACH)
        self._weight = np.asarray(weight[self._window])
        self._stretch = stretch

    def apply(self, field: Field) -> None:
        """Relax a field."""
        part = field[self._window]
        for damping in _DAMPINGS:
            _subtract_biharmonic(part, part, damping, self._stretch, self._weight)
        field[self._window] = part

    def apply_transpose(self, field: Field) -> None:
        """Change a field by the transpose."""
        part = field[self._window]
        for damping in reversed(_DAMPINGS):
            _subtract_biharmonic(part, self._weight * part, damping, self._stretch)
        field[self._window] = part


def _subtract_biharmonic(
    target: Field,
    field: Field,
    damping: np.float32,
    stretch: tuple[float, float],
    weight: Field | None = None,
) -> None:
    """Subtract ``damping`` × ``weight`` × h⁴ Δ² of ``field`` from ``target``."""
    wide = wrap_edges(field, 2)

    def subtract(rows: slice) -> None:
        change = _laplacian(_laplacian(wide[rows.start : rows.stop + 4], stretch), stretch)
        change *= damping
        if weight is not None:
            change *= weight[rows]
        target[rows] -= change

    in_threads(subtract, row_blocks(field.shape))


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


def wrap_edges(field: Field, width: int = 1) -> Field:
    """Return a periodic field padded by ``width`` cells at both ends of each axis."""
    wide = np.empty([n + 2 * width for n in field.shape], field.dtype)
    inner = wide[width:-width] if field.ndim == 1 else wide[width:-width, width:-width]

    def copy(rows: slice) -> None:
        inner[rows] = field[rows]

    in_threads(copy, row_blocks(field.shape))
    for axis in range(field.ndim):
        lines = np.moveaxis(wide, axis, 0)
        lines[:width] = lines[-2 * width : -width]
        lines[-width:] = lines[width : 2 * width]
    return wide
