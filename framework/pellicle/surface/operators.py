"""Pressure to displacement by FFT, on a periodic or on a free boundary.

Convention: û(q) = G(q) p̂(q), displacement u positive into the solid, transforms as in scipy.fft.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from functools import cached_property
from typing import Any, Protocol, Self, runtime_checkable

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from pellicle.arrays import Array
from pellicle.checks import component_name, errors_attributed_to, read_only, real_array, real_number
from pellicle.errors import ConfigError, shown
from pellicle.grid import Grid
from pellicle.units import readable

from .convolution import Float, Workspace, convolve
from .hankel import Tabulated
from .influence import cell_coefficients, warn_of_cells

# Least displacement of a cell under its own pressure, over that of the finest wave.
_LEAST_OWN = 0.25
# Width of cells over the thickness of a layer from which they are what is wrong.
_WIDE = 10.0


class HasCompliance(Protocol):
    """The part of a kernel that every operator needs."""

    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa] for wavenumbers q > 0 [rad/m]."""


@runtime_checkable
class HasClosedForm(HasCompliance, Protocol):
    """A kernel with formulas in real space; other kernels are tabulated on a free boundary."""

    def greens_function(self, r: Array) -> Array:
        """Return the displacement at distances r > 0 [m] from a unit force [m/N]."""

    def radial_primitive(self, r: Array) -> Array:
        """Return ∫₀^r G(r') r' dr' [m³/N] for r ≥ 0 [m]."""


@runtime_checkable
class HasMeanCompliance(HasCompliance, Protocol):
    """A kernel that states the displacement of its surface under a uniform pressure."""

    def mean_compliance(self) -> float:
        """Return G(0) [m/Pa], the displacement per uniform pressure on a periodic domain.

        If it is infinite, the mean displacement is set to 0 and depths are measured from the mean
        plane.
        """


def mean_compliance(kernel: HasCompliance) -> float:
    """Return G(0) [m/Pa] of a kernel; ∞ if it does not state G(0), as for a half-space."""
    if not isinstance(kernel, HasMeanCompliance):
        return math.inf
    with errors_attributed_to(kernel):
        value = kernel.mean_compliance()
    return real_number(kernel, "mean_compliance()", value)


def checked_call(kernel: HasCompliance, name: str) -> Callable[[Array], Array]:
    """Return a method of a kernel, wrapped to protect its argument and check its values.

    The function raises PluginError if the kernel returns anything but an array of real
    numbers of the shape of its argument.
    """
    method = getattr(kernel, name)
    text = f"{name}({'q' if name == 'compliance' else 'r'})"

    def call(argument: Array) -> Array:
        with errors_attributed_to(kernel):
            values = method(read_only(argument))
        return real_array(kernel, text, values, argument.shape)

    return call


class Operator:
    """The linear map from pressure [Pa] to displacement [m], both of the grid's shape.

    It is linear, symmetric and positive; `applications` counts its uses.
    """

    _symbol: _Symbol
    padded: tuple[int, int]
    """Number of points of the transform along x and y."""
    _has_mean: bool

    def __init__(self, kernel: HasCompliance, grid: Grid) -> None:
        self.kernel = kernel
        self.grid = grid
        self.workspace = Workspace()
        """Memory of the transforms, shared with `scaled` copies and preconditioners."""
        # Shared with `scaled` copies.
        self._count = [0]
        self._factor = 1.0
        self._spring_compliance = 0.0

    @property
    def has_mean_compliance(self) -> bool:
        """Whether a uniform pressure causes a displacement; if not, the mean displacement is 0."""
        return self._has_mean or self._spring_compliance > 0

    @property
    def applications(self) -> int:
        """Number of applications so far, including those of `scaled` copies."""
        return self._count[0]

    @property
    def greatest(self) -> float:
        """Greatest compliance of any wave [m/Pa]."""
        return self._symbol.greatest * self._factor

    @property
    def unit(self) -> float:
        """The largest power of two up to `greatest` [m/Pa]; 1 if that is 0."""
        return _power_of_two(self.greatest) if self.greatest else self._factor

    def with_spring(self, compliance: float) -> Self:
        """Return the operator for an indenter on a spring; it shares all arrays with this one.

        The deflection of the spring, ``compliance`` [m/N] times the force, is added to the
        displacement of every cell. It replaces the deflection of any earlier spring.
        """
        if compliance == self._spring_compliance:
            return self
        operator = copy.copy(self)
        operator._spring_compliance = compliance
        return operator

    def deflection(self, total: float) -> float:
        """Return the deflection of the spring [m] under pressures whose sum is ``total`` [Pa]."""
        return self._spring_compliance * self.grid.cell_area * total

    def mean_displacement(self, total: float) -> float:
        """Return the mean displacement [m] of a period under pressures whose sum is ``total`` [Pa].

        The deflection of a spring is not counted. It is 0 on a free boundary, where the surface has
        no mean plane.
        """
        return 0.0

    def scaled(self, factor: float) -> Self:
        """Return the operator times ``factor``; it shares all arrays with this one.

        The factor 1/`unit` brings its values near 1, as single precision requires: a compliance in
        m/Pa may be below its smallest number. A power of two changes no digit.
        """
        scaled = copy.copy(self)
        scaled._factor = self._factor * factor
        scaled._spring_compliance = self._spring_compliance * factor
        return scaled

    def coarsened(self) -> Operator:
        """Return the operator of the same kernel on `Grid.coarsened`, as `scaled` as this one."""
        coarse = make_operator(self.kernel, self.grid.coarsened()).scaled(self._factor)
        return coarse.with_spring(self._spring_compliance)

    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa] of the kernel at q > 0, `scaled` as the operator is."""
        return checked_call(self.kernel, "compliance")(q) * self._factor

    def __call__(
        self,
        pressure: NDArray[Float],
        out: NDArray[Float] | None = None,
        visit: Callable[[NDArray[Float], slice], None] | None = None,
    ) -> NDArray[Float]:
        """Return the displacement [m] under a pressure [Pa], in ``out`` or a new array.

        ``out`` may be ``pressure``. A pressure in single precision is transformed in single
        precision, in half the time. ``visit`` is called once with the displacement and each slice
        of rows, while these are in the cache; threads may share the slices.
        """
        self._count[0] += 1
        deflection = 0.0
        if self._spring_compliance:
            deflection = self.deflection(float(pressure.sum(dtype=np.float64)))
        symbol: NDArray[Any] = self._symbol.double
        if pressure.dtype != np.float64:
            symbol = self._symbol.single
        unit = self._symbol.unit * self._factor

        def finish(displacement: NDArray[Float], rows: slice) -> None:
            if unit != 1:
                displacement[rows] *= unit
            if deflection:
                displacement[rows] += deflection
            if visit:
                visit(displacement, rows)

        return convolve(pressure, symbol, self.padded, self.workspace, out, finish)


def _power_of_two(number: float) -> float:
    return 2.0 ** (math.frexp(number)[1] - 1)


class _Symbol:
    """The real Fourier symbol of an operator over its unit, in double and single precision."""

    def __init__(self, values: Array) -> None:
        self.greatest = float(np.abs(values).max())
        self.unit = _power_of_two(self.greatest) if self.greatest else 1.0
        values /= self.unit
        self.double = read_only(values)

    @cached_property
    def single(self) -> NDArray[np.float32]:
        """The symbol in single precision."""
        return read_only(self.double.astype(np.float32))


class PeriodicOperator(Operator):
    """G(q) sampled on the wavenumbers of the FFT.

    The mean displacement is 0 if the kernel's mean compliance is infinite.
    """

    def __init__(self, kernel: HasCompliance, grid: Grid) -> None:
        super().__init__(kernel, grid)
        qx, qy = grid.wavenumbers()
        q = np.hypot(qx, qy)
        mean = mean_compliance(kernel)
        # The mean compliance of an incompressible layer is 0.
        self._has_mean = 0 < mean < math.inf
        symbol = np.empty(q.shape)
        # The first wavenumber is 0.
        symbol.ravel()[0] = 0.0 if mean == math.inf else mean
        q = q.ravel()[1:]
        symbol.ravel()[1:] = values = checked_call(kernel, "compliance")(q)
        invalid = np.flatnonzero(~(np.isfinite(values) & (values > 0)))
        if invalid.size:
            raise ConfigError(
                f"compliance(q) of {component_name(kernel)} is {values[invalid[0]]:.3g} m/Pa at q "
                f"= {q[invalid[0]]:.3g} rad/m; it has to be positive and finite, and may be beyond "
                "the numbers that a computer has; check the parameters, or the formula if the "
                "kernel is yours",
                "kernel",
            )
        if not mean >= 0:
            raise ConfigError(
                f"mean_compliance() of {component_name(kernel)} is {mean:g} m/Pa; it has to be 0, "
                "positive or infinite; check the parameters, or the formula if the kernel is yours",
                "kernel",
            )
        self._symbol = _Symbol(symbol)
        self.padded = grid.shape

    def mean_displacement(self, total: float) -> float:
        """Return G(0) times the mean pressure [m]; see `Operator.mean_displacement`."""
        mean = float(self._symbol.double[0, 0]) * self._symbol.unit * self._factor
        return mean * (total / math.prod(self.grid.points))


class FreeOperator(Operator):
    """Discrete convolution with influence coefficients, zero-padded against periodic images.

    It is exact at the cell centres for a pressure that is uniform in each cell (Liu, Wang & Liu
    2000).
    """

    _has_mean = True

    def __init__(self, kernel: HasClosedForm, grid: Grid) -> None:
        super().__init__(kernel, grid)
        cells = cell_coefficients(
            checked_call(kernel, "greens_function"),
            checked_call(kernel, "radial_primitive"),
            grid.shape,
            grid.spacing,
        )
        if not (np.isfinite(cells).all() and cells[0, 0] > 0):
            raise ConfigError(
                "displacements are NaN, infinite or nowhere positive, maybe beyond the numbers "
                "that a computer has; check the parameters, or the formula if the kernel is yours",
                "kernel",
            )
        compliance = checked_call(kernel, "compliance")
        finest = float(compliance(np.array([np.pi / min(grid.spacing)]))[0])
        if not cells[0, 0] > _LEAST_OWN * finest:
            raise ConfigError(
                f"a pressed cell sinks by {cells[0, 0]:.2g} m/Pa at its centre, the finest wave by "
                f"{finest:.2g}: the cells are much wider than an incompressible layer is thick; "
                "use more points",
                "grid.points",
            )
        px, py = (scipy.fft.next_fast_len(2 * n - 1, real=True) for n in grid.shape)
        self.padded = px, py
        # In wrap-around order they are even in both directions, so the transform is real.
        nx, ny = cells.shape
        wrapped = np.zeros(self.padded)
        wrapped[:nx, :ny] = cells
        wrapped[px - nx + 1 :, :ny] = cells[:0:-1]
        wrapped[:, py - ny + 1 :] = wrapped[:, ny - 1 : 0 : -1]
        self._symbol = _Symbol(scipy.fft.rfft2(wrapped).real.copy())


def make_operator(kernel: HasCompliance, grid: Grid) -> Operator:
    """Return the operator of ``kernel`` on ``grid``.

    A kernel that cannot be used on this boundary, or whose values are not finite and positive, is a
    ConfigError; one that returns anything but real numbers of the argument's shape, a PluginError.
    """
    # Overflow gives infinite or NaN values, which are detected later.
    with np.errstate(all="ignore"):
        if grid.boundary == "periodic":
            return PeriodicOperator(kernel, grid)
        # These radii cover all coarser grids of the same domain, which reuse the table.
        shortest, longest = 0.2 * min(grid.spacing), 3 * math.hypot(*grid.size)
        if isinstance(kernel, Tabulated):
            if shortest < kernel.shortest or kernel.longest < longest:
                kernel = Tabulated(kernel.compliance, shortest, longest)
        elif not isinstance(kernel, HasClosedForm):
            try:
                kernel = Tabulated(checked_call(kernel, "compliance"), shortest, longest)
            except ConfigError as error:
                # An error of the kernel itself names its field.
                of_table = error.problems[0].field == "kernel"
                raise (of_table and _of_wide_cells(kernel, grid)) or error from None
        return FreeOperator(kernel, grid)


def _of_wide_cells(kernel: HasCompliance, grid: Grid) -> ConfigError | None:
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


def displacement(pressure: Array, *, kernel: HasCompliance, grid: Grid) -> Array:
    """Return the surface displacement [m] of shape (nx, ny) under a pressure [Pa] of that shape.

    This is one application of the operator. On a periodic grid the mean displacement is 0, unless
    the kernel states its mean compliance (`HasMeanCompliance`).

    Raises
    ------
    ConfigError
        The pressure is not a finite real array of the grid's shape, or ``kernel`` is not a kernel,
        or ``grid`` is not a grid.
    """
    if not hasattr(kernel, "compliance"):
        raise ConfigError(
            f"{shown(kernel)} is not a kernel; make one with pellicle.kernel(…)", "kernel"
        )
    if not isinstance(grid, Grid):
        raise ConfigError(f"{shown(grid)} is not a grid; make one with pellicle.Grid(…)", "grid")
    given = np.asarray(pressure)
    if given.shape != grid.shape or given.dtype.kind not in "fiu":
        raise ConfigError(
            f"is of shape {given.shape} and type {given.dtype}; give a real array of shape "
            f"{grid.shape}, the grid's",
            "pressure",
        )
    if not np.isfinite(given).all():
        raise ConfigError("holds NaN or infinite values; give finite ones in Pa", "pressure")
    operator = make_operator(kernel, grid)
    warn_of_cells(kernel.compliance, grid)
    return operator(given.astype(np.float64))
