"""Fields that extend over the plane beyond the domain, where only their integral is known.

Under a skin a solid that relaxes carries pressure outside the domain too. There it falls as r⁻³,
the transform of |q|. So what is missing from the known integral over the plane is spread as r⁻³.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from pellicle.arrays import Array
from pellicle.grid import Grid

from .from_kernel import HasSymbol, operator_of

# Edge of the larger plane over that of the domain, and its cells each way. With twice of both the
# force of a flat punch with a tensed skin changes by 2e-4 in a domain of 8 contact radii.
_LARGER: Final = 8
_CELLS: Final = 128


class PlaneOperator:
    """The operator of a kernel on fields whose integral over the plane is known.

    On a periodic boundary there is nothing outside the domain, and the integral is not used.
    """

    def __init__(self, kernel: HasSymbol, grid: Grid) -> None:
        self.operator = operator_of(kernel, grid)
        """The operator on fields that are 0 outside the domain."""
        self._from_outside = from_outside(kernel, grid) if grid.boundary == "free" else None

    def __call__(self, field: Array, integral: float) -> Array:
        """Return the operator applied to a field with this integral over the plane."""
        result = self.operator(field)
        if self._from_outside is not None:
            cell_area = self.operator.grid.cell_area
            result += self._from_outside * (integral - float(field.sum()) * cell_area)
        return result


def from_outside(kernel: HasSymbol, grid: Grid) -> Array:
    """Return the displacement [m/N] of each cell by 1 N spread as r⁻³ outside the domain.

    It is computed on a plane eight times as large, in coarse cells. The eighth of the force that
    acts beyond that plane is neglected: its displacement is about a sixty-fourth of the whole.
    """
    # The import takes long, and only a skin on a solid that relaxes needs it.
    from scipy.interpolate import RectBivariateSpline

    size = [_LARGER * edge for edge in grid.size]
    plane = Grid(points=(_CELLS, _CELLS), size=(size[0], size[1]), boundary="free")
    x, y = plane.coordinates()
    rows, columns = (
        np.flatnonzero(np.abs(line.ravel()) < edge / 2)
        for line, edge in zip((x, y), grid.size, strict=True)
    )
    domain = np.ix_(rows, columns)
    density: Array = np.hypot(x / min(size), y / min(size)) ** -3.0
    density[domain] = 0.0
    density *= (1 - 1 / _LARGER) / (density.sum() * plane.cell_area)
    displacement = operator_of(kernel, plane)(density)[domain]
    spline = RectBivariateSpline(x[rows, 0], y[0, columns], displacement)
    # Between the outermost coarse centres and the edge of the domain the spline is constant.
    fine_x, fine_y = grid.coordinates()
    field: Array = spline(fine_x[:, 0], fine_y[0])
    return field
