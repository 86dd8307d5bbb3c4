"""From a kernel to the operator of a grid: by its symbol, its closed form, or a table of that."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Protocol, cast, runtime_checkable

import numpy as np
import scipy.fft

from pellicle.arrays import Array
from pellicle.checks import component_name, errors_attributed_to, read_only, real_array, real_number
from pellicle.errors import ConfigError, excerpt
from pellicle.grid import Grid
from pellicle.units import readable

from .hankel import KernelTable
from .influence import cell_coefficients, warn_of_cells
from .operators import Operator, Symbol, along_axes

# Least displacement of a cell under its own pressure, over that of the finest wave.
_LEAST_OWN = 0.25
# Width of cells over the thickness of a layer from which they are what is wrong.
_WIDE = 10.0


class HasSymbol(Protocol):
    """The part of a kernel that every operator needs."""

    @property
    def is_isotropic(self) -> bool:
        """Whether the symbol depends on |q| alone."""

    def symbol(self, qx: Array, qy: Array) -> Array:
        """Return G [m/Pa] for wavenumbers q_x and q_y [rad/m], not both 0."""


@runtime_checkable
class HasClosedForm(Protocol):
    """A kernel with formulas in real space; other kernels are tabulated on a free boundary."""

    def greens_function(self, r: Array) -> Array:
        """Return the displacement at distances r > 0 [m] from a unit force [m/N]."""

    def radial_primitive(self, r: Array) -> Array:
        """Return ∫₀^r G(r') r' dr' [m³/N] for r ≥ 0 [m]."""


@runtime_checkable
class HasMeanCompliance(Protocol):
    """A kernel that states the displacement of its surface under a uniform pressure."""

    def mean_compliance(self) -> float:
        """Return G(0) [m/Pa], the displacement per uniform pressure on a periodic domain.

        If it is infinite, the mean displacement is set to 0 and depths are measured from the mean
        plane.
        """


def closed_form_of(kernel: object) -> HasClosedForm | None:
    """Return a kernel that has formulas in real space; None for one that has none."""
    has_both = hasattr(kernel, "greens_function") and hasattr(kernel, "radial_primitive")
    return cast(HasClosedForm, kernel) if has_both else None


def mean_compliance(kernel: object) -> float:
    """Return G(0) [m/Pa] of a kernel; ∞ if it does not state G(0), as for a half-space."""
    if not isinstance(kernel, HasMeanCompliance):
        return math.inf
    with errors_attributed_to(kernel):
        value = kernel.mean_compliance()
    return real_number(kernel, "mean_compliance()", value)


def checked_call(kernel: object, name: str) -> Callable[..., Array]:
    """Return a method of a kernel, wrapped to protect its arguments and check its values.

    The function raises PluginError if the kernel returns anything but an array of real
    numbers of the shape of its arguments.
    """
    method = getattr(kernel, name)
    text = words_of_call(kernel) if name in ("compliance", "symbol") else f"{name}(r)"

    def call(*arguments: Array) -> Array:
        with errors_attributed_to(kernel):
            values = method(*map(read_only, arguments))
        return real_array(kernel, text, values, arguments[0].shape)

    return call


def words_of_call(kernel: object) -> str:
    """Return what gives the symbol of a kernel, in words."""
    return "compliance(q)" if getattr(kernel, "is_isotropic", False) else "symbol(qx, qy)"


def operator_of(kernel: HasSymbol, grid: Grid) -> Operator:
    """Return the operator of ``kernel`` on ``grid``.

    A kernel that cannot be used on this boundary, or whose values are not finite and positive, is a
    ConfigError; one that returns anything but real numbers of the argument's shape, a PluginError.
    """
    if grid.boundary == "periodic":
        return _periodic(kernel, grid)
    if not kernel.is_isotropic:
        raise ConfigError(
            f"'free' needs a kernel that yields equally in all directions, and "
            f"{component_name(kernel)} does not; use boundary = 'periodic', on a domain much wider "
            "than the contact",
            "grid.boundary",
        )
    return _free(kernel, grid, closed_form_of(kernel))


def _periodic(kernel: HasSymbol, grid: Grid) -> Operator:
    """Return the operator of the symbol sampled on the wavenumbers of the FFT.

    The mean displacement is 0 if the kernel's mean compliance is infinite.
    """
    symbol = checked_call(kernel, "symbol")
    mean = mean_compliance(kernel)
    qx, qy = (q.ravel()[1:] for q in np.broadcast_arrays(*grid.wavenumbers()))
    # The first wavenumber is 0. The mean compliance of an incompressible layer is 0.
    values = np.empty((grid.shape[0], grid.shape[1] // 2 + 1))
    values.ravel()[0] = 0.0 if mean == math.inf else mean
    # Overflow gives infinite or NaN values, which are detected here.
    with np.errstate(all="ignore"):
        values.ravel()[1:] = waves = symbol(qx, qy)
        if grid.shape[0] % 2 == 0:
            # On the grid q_x = ±π/Δx are one wave; along y the transform takes the mean itself.
            middle = grid.shape[0] // 2
            shortest, across = (q[middle] for q in np.broadcast_arrays(*grid.wavenumbers()))
            values[middle] = 0.5 * (values[middle] + symbol(-shortest, across))
    invalid = np.flatnonzero(~(np.isfinite(waves) & (waves > 0)))
    if invalid.size:
        first = invalid[0]
        raise ConfigError(
            f"{words_of_call(kernel)} of {component_name(kernel)} is {waves[first]:.3g} m/Pa at q "
            f"= {np.hypot(qx[first], qy[first]):.3g} rad/m; it has to be positive and finite, and "
            "may be beyond the numbers that a computer has; check the parameters, or the formula "
            "if the kernel is yours",
            "kernel",
        )
    if not mean >= 0:
        raise ConfigError(
            f"mean_compliance() of {component_name(kernel)} is {mean:g} m/Pa; it has to be 0, "
            "positive or infinite; check the parameters, or the formula if the kernel is yours",
            "kernel",
        )
    return Operator(grid, values, grid.shape, symbol, lambda new_grid: _periodic(kernel, new_grid))


def _free(kernel: HasSymbol, grid: Grid, form: HasClosedForm | None) -> Operator:
    """Return the discrete convolution with influence coefficients of a ``form`` or of a table.

    It is zero-padded against periodic images, and exact at the cell centres for a pressure that is
    uniform in each cell (Liu, Wang & Liu 2000).
    """
    symbol = checked_call(kernel, "symbol")
    with np.errstate(all="ignore"):
        if form is None or isinstance(form, KernelTable):
            form = _table(kernel, symbol, grid, form)
        cells = cell_coefficients(
            checked_call(form, "greens_function"),
            checked_call(form, "radial_primitive"),
            grid.shape,
            grid.spacing,
        )
        if not (np.isfinite(cells).all() and cells[0, 0] > 0):
            raise ConfigError(
                "displacements are NaN, infinite or nowhere positive, maybe beyond the numbers "
                "that a computer has; check the parameters, or the formula if the kernel is yours",
                "kernel",
            )
        finest = symbol(np.array([np.pi / min(grid.spacing)]), np.zeros(1)).item()
        if not cells[0, 0] > _LEAST_OWN * finest:
            raise ConfigError(
                f"a pressed cell sinks by {cells[0, 0]:.2g} m/Pa at its centre, the finest wave by "
                f"{finest:.2g}: the cells are much wider than an incompressible layer is thick; "
                "use more points",
                "grid.points",
            )
        px, py = (scipy.fft.next_fast_len(2 * n - 1, real=True) for n in grid.shape)
        # In wrap-around order they are even in both directions, so the transform is real.
        nx, ny = cells.shape
        wrapped = np.zeros((px, py))
        wrapped[:nx, :ny] = cells
        wrapped[px - nx + 1 :, :ny] = cells[:0:-1]
        wrapped[:, py - ny + 1 :] = wrapped[:, ny - 1 : 0 : -1]
        values = scipy.fft.rfft2(wrapped).real.copy()
    return Operator(grid, values, (px, py), symbol, lambda new_grid: _free(kernel, new_grid, form))


def _table(kernel: HasSymbol, symbol: Symbol, grid: Grid, table: KernelTable | None) -> KernelTable:
    """Return a table of the displacement around a point force; ``table`` if that reaches."""
    # These radii cover all coarser grids of the same domain, which reuse the table.
    shortest, longest = 0.2 * min(grid.spacing), 3 * math.hypot(*grid.size)
    if table and table.shortest <= shortest and longest <= table.longest:
        return table
    try:
        return KernelTable(lambda q: symbol(q, np.zeros_like(q)), shortest, longest)
    except ConfigError as error:
        # An error of the kernel itself names its field.
        of_table = error.problems[0].field == "kernel"
        raise (of_table and _of_wide_cells(kernel, grid)) or error from None


def _of_wide_cells(kernel: HasSymbol, grid: Grid) -> ConfigError | None:
    """Return what is wrong with cells much wider than a layer is thick; None if they are not."""
    cell, thickness = min(grid.spacing), getattr(kernel, "depth_to_base", lambda: math.inf)()
    if cell < _WIDE * thickness:
        return None
    return ConfigError(
        f"cells of {readable(cell, 'm')} are {cell / thickness:.0f} times as wide as the layer is "
        "thick, too wide for its displacement around a point force; use more points, or a smaller "
        "grid.size",
        "grid.points",
    )


def displacement(pressure: Array, *, kernel: HasSymbol, grid: Grid) -> Array:
    """Return the surface displacement [m] of shape (nx, ny) under a pressure [Pa] of that shape.

    This is one application of the operator. On a periodic grid the mean displacement is 0, unless
    the kernel states its mean compliance (`HasMeanCompliance`).

    Raises
    ------
    ConfigError
        The pressure is not a finite real array of the grid's shape, or ``kernel`` is not a kernel,
        or ``grid`` is not a grid.
    """
    if not hasattr(kernel, "symbol"):
        raise ConfigError(
            f"{excerpt(kernel)} is not a kernel; make one with pellicle.kernel(…)", "kernel"
        )
    if not isinstance(grid, Grid):
        raise ConfigError(f"{excerpt(grid)} is not a grid; make one with pellicle.Grid(…)", "grid")
    tractions = np.asarray(pressure)
    if tractions.shape != grid.shape or tractions.dtype.kind not in "fiu":
        raise ConfigError(
            f"is of shape {tractions.shape} and type {tractions.dtype}; give a real array of shape "
            f"{grid.shape}, the grid's",
            "pressure",
        )
    if np.ma.is_masked(pressure) or not np.isfinite(tractions).all():
        raise ConfigError(
            "holds NaN, infinite or masked values; give finite ones in Pa", "pressure"
        )
    operator = operator_of(kernel, grid)
    warn_of_cells(partial(along_axes, operator.symbol), grid)
    return operator(tractions.astype(np.float64))
