"""Tables of areas F/E* over the depth and one length more, for many trials at once."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, lru_cache
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array
from pellicle.components import HasForceCurve, HasLayerForceCurve
from pellicle.errors import PluginError, excerpt

_DEPTHS, _STEP, _FINE = 0.1, 0.2, 0.1
"""Distances of nodes in the logarithm of the depth, and in what else: s, or a thickness."""
_NODES = 129
"""Nodes of the depth: more than five decades below the deepest."""
_ROWS = 200
"""Nodes of what else."""
_SCALE = 0.01
"""Length at which the nodes of s turn from even to logarithmic, over the deepest contact radius."""
_FURTHER = 3e3
"""How much deeper than a curve a contact without adhesion may be that has its depth with it."""
_NONE = np.zeros(1)
_THINNEST = 1e-3
"""Least thickness of a layer over the greatest depth."""
_LIMITS = np.arange(0.0, _FINE * _ROWS, 0.5)
"""Logarithms of thickness over the least one at which depth limits are tabulated."""
_Value = TypeVar("_Value")
AreasOfDepth = Callable[[float, Array], tuple[Array, Array]]
"""Areas [m²] at one σ and depths [m], and their derivatives by σ."""


def last(function: Callable[[Any], _Value]) -> Callable[[Any], _Value]:
    """Return a function that computes nothing anew while its argument is the same object."""
    known: tuple[Any, Any] = object(), None

    def of(argument: Any) -> _Value:
        nonlocal known
        of_last = known  # Threads may share it.
        if of_last[0] is not argument:
            known = of_last = argument, function(argument)
        value: _Value = of_last[1]
        return value

    return of


def checked_area(indenter: object, curve: object, depth: Array) -> Array:
    """Return F/E* [m²] of a force curve of an indenter, which may be a stranger's, at depths [m].

    It has to be float64 of their shape (n,), finite at every finite depth.
    """
    area = getattr(curve, "force", None)
    if not (
        isinstance(area, np.ndarray)
        and (area.dtype, area.shape) == (np.float64, depth.shape)
        and np.isfinite(area[np.isfinite(depth)]).all()
    ):
        raise PluginError(
            f"indenter {getattr(indenter, 'type_name', type(indenter).__name__)!r}: its force "
            f"curve is {excerpt(curve)}; it has to be a ForceCurve whose force is an array of "
            f"float64 of shape {depth.shape}, finite at all depths"
        )
    return area


class Table:
    """A/δ^1.5 over log δ by cubic splines, and over σ by cubics through values and slopes.

    Below the least node A grows as δ^1.5.  The values of a σ are computed when they are needed.
    """

    def __init__(
        self, row: AreasOfDepth, deepest: float, nodes: int = _NODES, spacing: float = _STEP
    ) -> None:
        self.row, self.spacing = row, spacing
        self.log = np.log(deepest) - _DEPTHS * np.arange(nodes)[::-1]
        self.depth = np.exp(self.log)
        self.coefficients = np.zeros((2, 4, _ROWS, nodes - 1))
        self.known = np.zeros(_ROWS, dtype=bool)

    def _fill(self, numbers: NDArray[np.intp]) -> None:
        from scipy.interpolate import CubicSpline

        for i in {*numbers[~self.known[numbers]].tolist()}:
            values, rates = self.row(self.spacing * i, self.depth)
            both = np.stack([values, self.spacing * rates], axis=1) / self.depth[:, None] ** 1.5
            self.coefficients[:, :, i] = np.moveaxis(CubicSpline(self.log, both).c, 2, 0)
            self.known[i] = True

    def of(self, sigma: Array) -> Array:
        """Return the coefficients of the spline at each σ, of shape (4, 1 or k, intervals)."""
        if not sigma.any():
            if not self.known[0]:
                self._fill(np.array([0]))
            return self.coefficients[0, :, :1]
        sigma = np.clip(sigma / self.spacing, 0.0, _ROWS - 1.001)
        if (sigma == sigma[0]).all():
            sigma = sigma[:1]
        i = sigma.astype(np.intp)
        u = (sigma - i)[:, None]
        self._fill(np.concatenate([i, i + 1]))
        w, low, high = u - 1, self.coefficients[:, :, i], self.coefficients[:, :, i + 1]
        of_low = (1 + 2 * u) * w**2 * low[0] + u * w**2 * low[1]
        return np.asarray(of_low + u**2 * (3 - 2 * u) * high[0] + u**2 * w * high[1])

    def areas(self, depth: Array, coefficients: Array) -> Array:
        """Return A [m²] at depths of shape (n,) or (k, n), of the splines of each σ."""
        inside = np.minimum(np.maximum(depth, 0.0), self.depth[-1])
        x = np.log(np.maximum(inside, self.depth[0])) - self.log[0]
        value = cubic(coefficients, x, _DEPTHS)
        value *= inside
        value *= np.sqrt(inside)
        return value

    def slopes(self, depth: Array, coefficients: Array) -> tuple[Array, Array]:
        """Return A [m²] and ∂A/∂δ [m] of the same."""
        inside = np.clip(depth, self.depth[0], self.depth[-1])
        x = np.log(inside) - self.log[0]
        rates = coefficients[:-1] * np.array([3.0, 2.0, 1.0])[:, None, None]
        value, root = cubic(coefficients, x, _DEPTHS), np.sqrt(inside)
        return value * inside * root, (1.5 * value + cubic(rates, x, _DEPTHS)) * root


@lru_cache(maxsize=8)
def _of_values(count: int) -> Array:
    """Coefficients of the splines through nodes of which one is 1, (powers, nodes, intervals)."""
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(np.arange(count), np.eye(count)).c.transpose(0, 2, 1)).copy()


def cubics(values: Array) -> Array:
    """Return the splines through rows of values, of shape (k, nodes), a step of 1 apart."""
    return np.asarray(values @ _of_values(values.shape[1]))


def cubic(coefficients: Array, x: Array, step: float) -> Array:
    """Return polynomials of shape (powers, 1 or k, intervals) at 0 ≤ x of shape (n,) or (k, n)."""
    powers, rows, count = coefficients.shape
    j = np.minimum((x * (1 / step)).astype(np.intp), count - 1)
    x = x - step * j
    if rows > 1:
        j = j + count * np.arange(rows)[:, None]
    flat = coefficients.reshape(powers, -1)
    value: Array = flat[0].take(j)
    for power in flat[1:]:
        value *= x
        value += power.take(j)
    return value


class Areas:
    """Areas of a body over depth and s = scale (e^σ − 1), down to a depth [m]."""

    def __init__(
        self, body: HasForceCurve, deepest: float, scale: float, nodes: int = _NODES
    ) -> None:
        self.body, self.deepest, self.scale, self.nodes = body, deepest, scale, nodes
        self.table = Table(self._row, deepest, nodes)
        self._splines = last(lambda length: self.table.of(self._sigma(length)))
        self._wide_splines = last(lambda length: self.wide.of(self._sigma(length)))

    def __reduce__(self) -> tuple[Any, ...]:
        # A result that goes to another process takes no table along.
        return Areas, (self.body, self.deepest, self.scale, self.nodes)

    @cached_property
    def wide(self) -> Table:
        """A table that goes further than any depth at which nothing attracts."""
        reach = min(_FURTHER * self.deepest, self.body.depth_limit)
        return Table(self._row, reach, self.nodes + round(np.log(_FURTHER) / _DEPTHS))

    def _row(self, sigma: float, depth: Array) -> tuple[Array, Array]:
        length = self.scale * float(np.expm1(sigma))
        curve = self.body.force_curve(depth, length)
        return checked_area(self.body, curve, depth), curve.by_length * (length + self.scale)

    def _sigma(self, length: Array | float) -> Array:
        return np.log1p(np.ravel(length) / self.scale) if np.any(length) else _NONE

    def __call__(self, depth: Array, length: Array | float) -> Array:
        """Return F/E* [m²]."""
        return self.table.areas(depth, self._splines(length))

    def slopes(self, depth: Array, length: Array | float) -> tuple[Array, Array]:
        """Return F/E* [m²] and its derivative by the depth [m]."""
        return self.wide.slopes(depth, self._wide_splines(length))


@lru_cache(maxsize=64)
def half_space(body: HasForceCurve, deepest: float) -> Areas:
    """Return the areas of a body, down to a depth [m]."""
    depth = np.array([deepest])
    curve = body.force_curve(depth, 0.0)
    checked_area(body, curve, depth)
    return Areas(body, deepest, _SCALE * float(curve.by_depth[0]) / 2)


@lru_cache(maxsize=64)
def layer(
    body: HasLayerForceCurve, deepest: float, ratio: float
) -> tuple[Callable[[Array, Array], Array], Callable[[Array], Array]]:
    """Return area over depth and thickness without tension, and the greatest depth."""
    thinnest = _THINNEST * deepest

    def row(sigma: float, depth: Array) -> tuple[Array, Array]:
        thickness = thinnest * float(np.exp(sigma))
        curve = body.layer_force_curve(depth, 0.0, thickness, ratio)
        return checked_area(body, curve, depth), curve.by_thickness * thickness

    table = Table(row, deepest, spacing=_FINE)
    depths = [body.layer_depth_limit(thinnest * float(np.exp(x)), ratio) for x in _LIMITS]
    limits = np.maximum(depths, 1e-300)

    splines = last(lambda thickness: table.of(np.log(np.ravel(thickness) / thinnest)))

    def area(depth: Array, thickness: Array) -> Array:
        return table.areas(depth, splines(thickness))

    def limit(thickness: Array) -> Array:
        return np.exp(np.interp(np.log(thickness / thinnest), _LIMITS, np.log(limits)))

    return area, limit
