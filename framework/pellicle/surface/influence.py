"""Influence coefficients: integrals of a radial Green's function over rectangular cells.

The integration depends on the distance from the loaded cell in units of the longer side D of a
cell:

- up to 8 D in x and in y: exact, as a signed sum of corner integrals of the radial primitive;
- up to a radius of about 32 D: 4 × 4 Gauss–Legendre points of the Green's function per cell;
- beyond: the mean over a cell by central differences, from the Green's function at the centres of
  the cell and of its neighbours, at the cost of one evaluation per cell.

All three keep the relative error of a coefficient below 1e-10 (typically 3e-12) for kernels that
vary on the scale of r itself, between log(1/r) and 1/r, such as the half-space (Love 1929, Phil.
Trans. R. Soc. A 228) and the tensed membrane (Hajji 1978, J. Appl. Mech. 45). Rounding in the
corner sums grows with the aspect ratio a of the cells, about as 64 a times the machine precision.

The pressure is uniform in each cell and the displacement is taken at its centre. A wave p = cos qx
on such cells contains its aliases q + 2πm/Δ, which are equal at the centres. So cells replace the
kernel G(q) by

    Σ_m (−1)^m sin(qΔ/2) / (qΔ/2 + πm) G(|q + 2πm/Δ|),

which is G(q) to a few per mille if G falls with q. The compliance of an incompressible bonded
layer vanishes for long waves; on cells wider than the layer, aliases of short waves dominate it.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable

import numpy as np

from pellicle.arrays import Array
from pellicle.grid import Grid
from pellicle.units import readable

Radial = Callable[[Array], Array]
Spacing = tuple[float, float]
Shape = tuple[int, int]

_EXACT_REACH = 8
_GAUSS_REACH = 32.1  # not an integer, so that rounding never decides which rule applies
_GAUSS_POINTS = 4
_BLOCK_ELEMENTS = 32768  # keeps the temporaries of a block of rows in the cache

# The mean over a unit cell is f + d2/24 − 17 d4/5760 + 367 d6/967680 with central differences d2,
# d4, d6, from the operator δ / (2 asinh(δ/2)); here as weights of the neighbours 0, 1, 2, 3.
_D2, _D4, _D6 = 1 / 24, -17 / 5760, 367 / 967680
_MEAN_WEIGHTS = (
    1 - 2 * _D2 + 6 * _D4 - 20 * _D6,
    _D2 - 4 * _D4 + 15 * _D6,
    _D4 - 6 * _D6,
    _D6,
)
_HALO = len(_MEAN_WEIGHTS) - 1

_WAVE = 16  # cells
_ALIASES = 200  # on either side; the sum is accurate to about 1e-5
_ALLOWED = 0.03
_FINER = 1.25
_FINEST = 100.0  # largest factor on the points each way that is recommended


def cell_coefficients(
    greens_function: Radial, radial_primitive: Radial, shape: Shape, spacing: Spacing
) -> Array:
    """Return integrals of the Green's function over cells at all offsets (i, j) of a grid.

    They are the displacements [m/Pa] at the centre of a cell under unit pressure on the cell that
    lies i dx and j dy away, from G(r) [m/N] for r > 0 and P(R) = ∫₀^R G r dr [m³/N] for R ≥ 0 [m].
    """
    (nx, ny), (dx, dy) = shape, spacing
    if dx == dy and nx < ny:
        flipped = cell_coefficients(greens_function, radial_primitive, (ny, nx), spacing)
        return np.ascontiguousarray(flipped.T)
    coefficients = _far_cells(greens_function, shape, spacing)
    _overwrite_middle(coefficients, greens_function, spacing)
    _overwrite_near(coefficients, radial_primitive, spacing)
    return coefficients


def _far_cells(greens_function: Radial, shape: Shape, spacing: Spacing) -> Array:
    """Return coefficients valid far from the origin; for square cells only i ≥ j is computed."""
    nx, ny = shape
    symmetric = spacing[0] == spacing[1]
    result = np.empty(shape)
    rows = max(8 * _HALO, _BLOCK_ELEMENTS // ny)
    for start in range(0, nx, rows):
        stop = min(start + rows, nx)
        columns = min(stop, ny) if symmetric else ny
        # G at the cell centres of the rows and columns and of a margin around them.
        x = np.arange(start - _HALO, stop + _HALO) * spacing[0]
        y = np.arange(-_HALO, columns + _HALO) * spacing[1]
        square = (x * x)[:, None] + y * y
        # The origin is singular; any finite value will do, as near cells are overwritten.
        np.maximum(square, min(spacing) ** 2, out=square)
        lattice = greens_function(np.sqrt(square, out=square))
        result[start:stop, :columns] = _mean_along_rows(_mean_along_rows(lattice).T).T
        if symmetric and start < ny:
            result[:start, start:columns] = result[start:columns, :start].T
    result *= spacing[0] * spacing[1]
    return result


def _mean_along_rows(values: Array) -> Array:
    """Return cell means along the first axis, (n + 2 halo, m) → (n, m), exact for degree 7."""
    size = values.shape[0] - 2 * _HALO
    mean = values[_HALO : _HALO + size] * _MEAN_WEIGHTS[0]
    for k, weight in enumerate(_MEAN_WEIGHTS[1:], start=1):
        pair = values[_HALO - k : _HALO - k + size] + values[_HALO + k : _HALO + k + size]
        pair *= weight
        mean += pair
    return mean


def _overwrite_middle(coefficients: Array, greens_function: Radial, spacing: Spacing) -> None:
    """Replace the coefficients within the Gauss reach by Gauss-Legendre integrals."""
    reach = _GAUSS_REACH * max(spacing)
    nx, ny = (int(min(n, reach / d + 1)) for n, d in zip(coefficients.shape, spacing, strict=True))
    x, y = np.arange(nx) * spacing[0], np.arange(ny) * spacing[1]
    i, j = np.nonzero((x * x)[:, None] + y * y < reach**2)
    nodes, weights = np.polynomial.legendre.leggauss(_GAUSS_POINTS)
    x_points = x[i] + nodes[:, None] * (spacing[0] / 2)
    y_points = y[j] + nodes[:, None] * (spacing[1] / 2)
    values = greens_function(np.sqrt(x_points[:, None] ** 2 + y_points[None] ** 2))
    area = spacing[0] * spacing[1]
    coefficients[i, j] = np.einsum("p,q,pqn->n", weights, weights, values) * (area / 4)


def _overwrite_near(coefficients: Array, radial_primitive: Radial, spacing: Spacing) -> None:
    """Replace the coefficients near the origin by exact sums of corner integrals."""
    nx, ny = (
        min(n, round(_EXACT_REACH * max(spacing) / d) + 1)
        for n, d in zip(coefficients.shape, spacing, strict=True)
    )
    x = (np.arange(nx) + 0.5) * spacing[0]
    y = (np.arange(ny) + 0.5) * spacing[1]
    # F(x, y) = ∫₀^x ∫₀^y G over a rectangle is the sum over two triangles.
    column, row = x[:, None], y[None, :]
    corners = _triangle(radial_primitive, column, row) + _triangle(radial_primitive, row, column)
    # F is odd in x and in y, which gives the corners at -1/2 of the cells on the axes.
    corners = np.concatenate((-corners[:1], corners), axis=0)
    corners = np.concatenate((-corners[:, :1], corners), axis=1)
    coefficients[:nx, :ny] = np.diff(np.diff(corners, axis=0), axis=1)


def _triangle(radial_primitive: Radial, x: Array, y: Array) -> Array:
    """Return the integral of G over the triangle (0, 0), (x, 0), (x, y).

    In polar coordinates it is ∫ P(x / cos t) dt over 0 < t < atan(y/x). With tan t = sinh u it is
    ∫ P(x cosh u) / cosh u du over 0 < u < asinh(y/x), smooth even for slender triangles.
    """
    length = np.arcsinh(y / x)
    # The strip of analyticity |Im u| < π/2 is fixed, so the order must grow with the length.
    nodes, weights = np.polynomial.legendre.leggauss(16 + int(6 * length.max()))
    cosh = np.cosh(length[..., None] * (nodes + 1) / 2)
    values = radial_primitive(x[..., None] * cosh) / cosh
    return np.asarray(values @ weights * length / 2, dtype=np.float64)


def error_of_cells(compliance: Callable[[Array], Array], spacing: float) -> float:
    """Return the relative error of the compliance for a wave of 16 cells of width ``spacing`` [m].

    ``compliance`` is G(q) [m/Pa] for q > 0 [rad/m]. The error is NaN if G has no finite values.
    """
    orders = np.arange(-_ALIASES, _ALIASES + 1)
    phase = np.pi / _WAVE + np.pi * orders
    with np.errstate(all="ignore"):
        values = np.asarray(compliance(np.abs(2 * phase / spacing)), dtype=np.float64)
        weights = np.where(orders % 2, -1.0, 1.0) * np.sin(np.pi / _WAVE) / phase
        total = (weights * values).sum() / np.broadcast_to(values, phase.shape)[_ALIASES]
    return float(total) - 1.0


def warn_of_cells(compliance: Callable[[Array], Array], grid: Grid) -> None:
    """Warn if cells on a free boundary are too wide for an accuracy of a few per cent."""
    if grid.boundary != "free":
        return
    errors = [error_of_cells(compliance, spacing) for spacing in dict.fromkeys(grid.spacing)]
    error = max(errors, key=lambda value: abs(value) if math.isfinite(value) else 0.0)
    if not abs(error) > _ALLOWED:
        return
    factor, enough = 1.0, "more points"
    while (factor := factor * _FINER) < _FINEST:
        if all(abs(error_of_cells(compliance, d / factor)) <= _ALLOWED for d in grid.spacing):
            nx, ny = (math.ceil(n * factor) for n in grid.points)
            enough = f"about {nx} × {ny} points"
            break
    warnings.warn(
        f"grid.points: cells of {' × '.join(readable(d, 'm', 3) for d in grid.spacing)} yield to "
        f"long waves by {abs(error):.0%} {'more' if error > 0 else 'less'} than the kernel does, "
        "and forces are likely to be as wrong; an incompressible layer needs cells no wider than "
        f"it is thick: use {enough}",
        stacklevel=3,
    )
