"""An approximate inverse of the operator restricted to the contact: Eᵀ K E."""

from __future__ import annotations

from typing import Final

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from pellicle.grid import Grid
from pellicle.operators import Array, Operator

from .extension import Extension, levels_within

# Without a margin, contact at the edge of a free domain couples across it.
_FREE_MARGIN: Final = 1.25
_FREE_MULTIPLE: Final = 32


class Preconditioner:
    """Eᵀ K E in single precision, for one grid and any contact.

    ⟨A_cc⁻¹ v, v⟩ is the least ⟨k(q) w, w⟩ of all extensions w of v to the plane. E makes a smooth
    one, which is nearly the least, and K multiplies by the stiffness k(q) = 1/G(q).
    """

    def __init__(self, operator: Operator) -> None:
        grid = operator.grid
        self._shape = grid.shape
        # The transform's shape, and that of the extension, whose pyramid needs even numbers.
        if grid.boundary == "periodic":
            self._plane = grid.shape
            multiple = 2 ** levels_within(grid.shape)
            self._padded = _round_up(grid.shape, multiple)
        else:
            self._plane = self._padded = _free_shape(grid.shape)
        self._symbol = _stiffness(operator, self._plane)

    def restrict(self, contact: NDArray[np.bool_]) -> None:
        """Work on ``contact``, bool of the grid's shape, from now on."""
        known = np.zeros(self._plane, dtype=bool)
        known[: self._shape[0], : self._shape[1]] = contact
        self._extension = Extension(self._pad(known))

    def __call__(self, residual: Array) -> Array:
        """Return the preconditioned residual; both are of the grid's shape, 0 off the contact."""
        (nx, ny), (mx, my) = self._shape, self._plane
        given = np.zeros(self._plane, dtype=np.float32)
        given[:nx, :ny] = residual
        plane = self._extension.spread(self._pad(given))[:mx, :my]
        transform = scipy.fft.rfft2(plane)
        transform *= self._symbol
        force = np.zeros(self._padded, dtype=np.float32)
        force[:mx, :my] = scipy.fft.irfft2(transform, s=(mx, my), overwrite_x=True)
        return self._unpad(self._extension.gather(force))[:nx, :ny].astype(np.float64)

    def _pad(self, field: NDArray[np.generic]) -> NDArray[np.generic]:
        """Continue a periodic field to the padded shape."""
        if self._padded == self._plane:
            return field
        widths = [(0, p - m) for p, m in zip(self._padded, self._plane, strict=True)]
        return np.pad(field, widths, mode="wrap")

    def _unpad(self, field: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the transpose of `_pad` applied to a field."""
        mx, my = self._plane
        folded = field[:mx].copy()
        folded[: self._padded[0] - mx] += field[mx:]
        whole = folded[:, :my]
        whole[:, : self._padded[1] - my] += folded[:, my:]
        return whole


def _free_shape(shape: tuple[int, int]) -> tuple[int, int]:
    nx, ny = (
        _FREE_MULTIPLE * scipy.fft.next_fast_len(int(np.ceil(_FREE_MARGIN * n / _FREE_MULTIPLE)))
        for n in shape
    )
    return nx, ny


def _round_up(shape: tuple[int, int], multiple: int) -> tuple[int, int]:
    nx, ny = (-(-n // multiple) * multiple for n in shape)
    return nx, ny


def _stiffness(operator: Operator, shape: tuple[int, int]) -> NDArray[np.float32]:
    """Return k(q) over its greatest value on the wavenumbers of a periodic plane."""
    dx, dy = operator.grid.spacing
    plane = Grid(points=shape, size=(shape[0] * dx, shape[1] * dy), boundary="periodic")
    q = np.hypot(*plane.wavenumbers())
    # At q = 0 half of the lowest stiffness keeps K positive.
    q[0, 0] = 2 * np.pi / max(plane.size)
    stiffness = 1 / operator.kernel.compliance(q)
    stiffness[0, 0] /= 2
    return (stiffness / stiffness.max()).astype(np.float32)
