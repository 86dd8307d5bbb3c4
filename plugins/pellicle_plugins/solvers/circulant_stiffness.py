"""The stiffness of the surface on a periodic plane, a circulant matrix."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pellicle import Grid
from pellicle.surface import Operator, convolve

Field = NDArray[np.float32]


class CirculantStiffness:
    """K, the multiplication by k(q) = 1/G(q) over its greatest value, in single precision.

    The periodic plane has ``shape`` cells of the size of those of ``operator``.
    """

    def __init__(self, operator: Operator, shape: tuple[int, int]) -> None:
        dx, dy = operator.grid.spacing
        plane = Grid(points=shape, size=(shape[0] * dx, shape[1] * dy), boundary="periodic")
        q = np.hypot(*plane.wavenumbers())
        # At q = 0 half of the stiffness of the longest wave keeps K positive definite.
        q[0, 0] = 2 * np.pi / max(plane.size)
        stiffness = 1 / operator.compliance(q)
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
