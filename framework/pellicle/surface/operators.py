"""Pressure to displacement by FFT, on a periodic or on a free boundary.

Convention: û(q) = G(q) p̂(q), displacement u positive into the solid, transforms as in scipy.fft.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array
from pellicle.checks import read_only
from pellicle.grid import Grid

from .convolution import Float, Workspace, convolve

# Order of the stiffness at the size of a cell below which the surface is a bed of springs: that of
# a bonded layer is 0.01, 0.25 and 0.8 where its thickness is 0.4, 0.8 and 1.6 cells.
_BED: Final = 0.5

Symbol = Callable[[Array, Array], Array]
"""G [m/Pa] of the waves q_x, q_y [rad/m], two arrays of one shape; real and even."""

_SMALL = 2**16
"""Cells of a grid up to which what is made from its operator is kept."""


class Operator:
    """The linear map from pressure [Pa] to displacement [m], both of the grid's shape.

    It is linear, symmetric and positive; `applications` counts its uses.
    """

    def __init__(
        self,
        grid: Grid,
        values: Array,
        padded: tuple[int, int],
        symbol: Symbol,
        on: Callable[[Grid], Operator],
    ) -> None:
        """Take over ``values`` [m/Pa], by which transforms of the shape ``padded`` are multiplied.

        ``symbol`` is the same of any wave.
        """
        self.grid = grid
        self.padded = padded
        """Number of points of the transform along x and y."""
        self._values = _Values(values)
        self._symbol = symbol
        self.on = on
        """Returns the operator of the same solid on another grid."""
        self.workspace = Workspace()
        """Memory of the transforms, shared with `scaled` copies and preconditioners."""
        self.cache: dict[object, Any] = {}
        """What `keep` has kept, shared with `scaled` copies."""
        # Shared with `scaled` copies.
        self._count = [0]
        self._factor = 1.0
        self._spring_compliance = 0.0

    @property
    def has_mean_compliance(self) -> bool:
        """Whether a uniform pressure causes a displacement; if not, the mean displacement is 0."""
        return (
            self.grid.boundary == "free"
            or bool(self._values.double[0, 0] > 0)
            or self._spring_compliance > 0
        )

    @property
    def has_mirrors(self) -> bool:
        """Whether a cell displaces those at x and −x alike, and at y and −y."""
        values = self._values.double
        return self.grid.boundary == "free" or bool((values[1:] == values[:0:-1]).all())

    @property
    def factors(self) -> Array:
        """The factors [m/Pa] by which transforms of the shape `padded` are multiplied."""
        factors: Array = self._values.double * (self._values.unit * self._factor)
        return factors

    @property
    def applications(self) -> int:
        """Number of applications so far, including those of `scaled` copies."""
        return self._count[0]

    @property
    def greatest(self) -> float:
        """Greatest compliance of any wave [m/Pa]."""
        return self._values.greatest * self._factor

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
        if self.grid.boundary == "free":
            return 0.0
        mean = float(self._values.double[0, 0]) * self._values.unit * self._factor
        return mean * (total / math.prod(self.grid.points))

    def scaled(self, factor: float) -> Self:
        """Return the operator times ``factor``; it shares all arrays with this one.

        The factor 1/`unit` brings its values near 1, as single precision requires: a compliance in
        m/Pa may be below its smallest number. A power of two changes no digit.
        """
        scaled = copy.copy(self)
        scaled._factor = self._factor * factor
        scaled._spring_compliance = self._spring_compliance * factor
        return scaled

    def keep(self, key: object, made: object) -> None:
        """Keep what is made from it for all load steps, in the place of what was at this key.

        On a large grid it is not kept: making it takes little of the time, and keeping it memory.
        """
        if math.prod(self.grid.shape) <= _SMALL:
            self.cache[key] = made

    def coarsened(self) -> Operator:
        """Return the operator of the same solid on `Grid.coarsened`, as `scaled` as this one.

        It uses the memory of the transforms of this one.
        """
        coarse: Operator | None = self.cache.get("coarsened")
        if coarse is None:
            coarse = self.on(self.grid.coarsened())
            coarse.workspace = self.workspace
            self.keep("coarsened", coarse)
        return coarse.scaled(self._factor).with_spring(self._spring_compliance)

    def symbol(self, qx: Array, qy: Array) -> Array:
        """Return G [m/Pa] of any waves but q = 0, `scaled` as the operator is."""
        return self._symbol(qx, qy) * self._factor

    def orders(self, number: int) -> list[float]:
        """Return the powers of q with which the stiffness grows at the size of 1, 2, 4, 8 … cells.

        Where it falls the power is 0. The waves are those along the axes.
        """
        (nx, ny), (dx, dy) = self.grid.shape, self.grid.spacing
        # An axis of one cell has no waves.
        longest = max(dx if nx > 1 else dy, dy if ny > 1 else dx)
        q = np.pi / longest * 0.5 ** np.arange(number + 1, dtype=np.float64)
        stiffness = 1 / along_axes(self.symbol, q)
        return [max(0.0, float(order)) for order in -np.diff(np.log2(stiffness))]

    @cached_property
    def is_bed(self) -> bool:
        """Whether cells yield on their own, as on springs or a layer thinner than them."""
        return self.orders(1)[0] < _BED

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
        values: NDArray[Any] = self._values.double
        if pressure.dtype != np.float64:
            values = self._values.single
        unit = self._values.unit * self._factor

        def finish(displacement: NDArray[Float], rows: slice) -> None:
            if unit != 1:
                displacement[rows] *= unit
            if deflection:
                displacement[rows] += deflection
            if visit:
                visit(displacement, rows)

        return convolve(pressure, values, self.padded, self.workspace, out, finish)


def _power_of_two(number: float) -> float:
    return 2.0 ** (math.frexp(number)[1] - 1)


def along_axes(symbol: Symbol, q: Array) -> Array:
    """Return G [m/Pa] of waves q > 0 [rad/m] along the axes: the mean of that along x and along y.

    It is a scale of the compliance; of an isotropic kernel it is G(q).
    """
    nothing = np.zeros_like(q)
    mean: Array = 0.5 * (symbol(q, nothing) + symbol(nothing, q))
    return mean


def weighted_sum(operators: Sequence[Operator], weights: Sequence[float]) -> Operator:
    """Return the sum of ``operators`` on one grid, each times its weight.

    The weights may make it the derivative of an operator, which need not be positive.
    """

    def symbol(qx: Array, qy: Array) -> Array:
        terms = [w * o.symbol(qx, qy) for o, w in zip(operators, weights, strict=True)]
        summed: Array = np.sum(terms, axis=0)
        return summed

    def on(grid: Grid) -> Operator:
        total: Array | float = 0.0
        for operator, weight in zip(operators, weights, strict=True):
            same = operator if grid == operator.grid else operator.on(grid)
            total = total + weight * same.factors
        return Operator(grid, np.asarray(total), same.padded, symbol, on)

    return on(operators[0].grid)


class _Values:
    """The factors of transforms over their unit, in double and single precision."""

    def __init__(self, values: Array) -> None:
        self.greatest = float(np.abs(values).max())
        self.unit = _power_of_two(self.greatest) if self.greatest else 1.0
        values /= self.unit
        self.double = read_only(values)

    @cached_property
    def single(self) -> NDArray[np.float32]:
        """The same in single precision."""
        return read_only(self.double.astype(np.float32))
