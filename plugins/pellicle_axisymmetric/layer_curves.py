"""Force against depth on a bonded layer under surface tension, interpolated between solutions.

Force and depth are tabulated at given contact radii a (``docs/reference-data/curve_tables.py``).
There the equation is linear in the profile, so that force and depth of nine odd Chebyshev
polynomials are those of every smooth profile.  The table holds them on a half-space, over s/a,
and what the layer changes, over s/h, a/h and ν; s = 2τ₀/E*.  Between the radii, the logarithm of
the force over that on a half-space at the same depth (``master_curves``) is interpolated over the
depth.

The relative error of the force is below 1e-4 for contacts up to ten times as wide as the layer is
thick, of a sphere up to a = 0.8 R.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from pellicle.arrays import Array
from pellicle.components import ForceCurve, LayerForceCurve

from . import master_curves
from .depth_curves import contact_part
from .splines import Interpolant, stretched_spline, table_in

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

PROFILES = 9
"""Number of odd Chebyshev polynomials of which the Abel slope of a smooth indenter consists."""
RATIO_NODES = 11
_SPREAD = 0.01
"""1 − 2ν at which the nodes in ν turn from logarithmic to uniform spacing."""
LENGTH_SCALE = 3e-4
LENGTHS: Array = LENGTH_SCALE * np.expm1(np.linspace(0.0, np.log1p(3e3 / LENGTH_SCALE), 24))
"""Nodes s/h."""
WIDEST = 10.0
"""Largest a/h at which the curve holds."""
CONFINEMENT_SCALE = 1e-3
_LAST, _COUNT = 14.0, 33
"""Last node a/h and number of nodes; splines err most at their end."""
_POINTS = 50
"""Contact radii on the curve of an indenter that ends."""
HALF_SPACE_SCALE = 1e-3
HALF_SPACE_LENGTHS: Array = HALF_SPACE_SCALE * np.expm1(np.arange(0.0, 23.1, 0.15))
"""Nodes s/a."""
_FILLED = 0.8
"""Largest contact radius over the end of the profile."""
FILE = Path(__file__).with_name("layer_curves.npz")
Shape = Literal["smooth", "pointed", "punch"]
"""An indenter of revolution with a smooth apex, with a corner there, or with a flat end."""


class TensedLayer(NamedTuple):
    """A layer bonded to a rigid base, under surface tension."""

    length: float
    """s = 2τ₀/E* [m]."""
    thickness: float
    """h [m]."""
    poissons_ratio: float
    """ν, from 0 to ½."""


@dataclass(frozen=True)
class Profile:
    """An indenter of revolution that is not flat."""

    shape: Shape
    limit: float
    """End of the profile [m]; infinite if there is none."""
    exponent: float
    """p of the contact radius of a shallow contact without tension, a ~ δ^p."""
    scale: float
    """Depth [m] of such a contact at a radius of 1 m."""
    coefficients: Callable[[Array], Array]
    """Coefficients of h′ at contact radii of shape (n,), of shape (n, number of profiles)."""
    half_space: Callable[[Array, float], ForceCurve]
    """P/E* on a half-space, at depths and s, of the shallow limit of the profile."""

    def depth_limit(self, thickness: float, poissons_ratio: float) -> float:
        """Return the depth [m] up to which the curve holds without tension, at most h.

        With tension it holds to a greater depth.
        """
        widest = np.array([min(WIDEST * thickness, _FILLED * self.limit)])
        nodes = _nodes(self, TensedLayer(0.0, thickness, poissons_ratio), widest)
        return min(float(nodes.depth[0]), thickness)

    def curve(self, depth: Array, layer: TensedLayer) -> LayerForceCurve:
        """Return P/E* and its derivatives at depths [m] of shape (n,), 0 without contact."""
        change, rates, last = _splines(self, layer)
        touches, d = contact_part(depth)
        x, x_rate = self.stretch(d, layer.thickness)
        inside = np.minimum(x, last)
        slope = change(inside, 1)
        factor = np.exp(change(inside) + slope * (x - inside))
        base = self.half_space(d, layer.length)
        force = base.force * factor
        by_length, by_thickness = (rates(inside) + rates(inside, 1) * (x - inside)[:, None]).T
        out = np.zeros((4, depth.size))
        out[:, touches] = (
            force,
            base.by_depth * factor + force * slope * x_rate,
            base.by_length * factor + force * by_length,
            force * by_thickness,
        )
        return LayerForceCurve(*out)

    def stretch(self, depth: Array, thickness: float) -> tuple[Array, Array]:
        """Return the variable x in which a change of log P is smooth, and dx/dδ."""
        unit = self.scale * (CONFINEMENT_SCALE * thickness) ** (1 / self.exponent)
        power = (depth / unit) ** self.exponent
        rate: Array = self.exponent * power / (1 + power) / depth
        return np.log1p(power), rate


@dataclass(frozen=True)
class Punch:
    """A flat punch."""

    radius: float
    """a [m]."""

    def depth_limit(self, thickness: float, poissons_ratio: float) -> float:
        """Return the thickness [m], or 0 where the punch is too wide for the table."""
        return thickness if self.radius <= WIDEST * thickness else 0.0

    def curve(self, depth: Array, layer: TensedLayer) -> LayerForceCurve:
        """Return P/E* and its derivatives at depths [m] of shape (n,), 0 without contact."""
        confinement = np.array([self.radius / layer.thickness])
        change, by_length, by_confinement = (
            float(value[0, 0]) for value in _changes("punch", layer, confinement)
        )
        base = master_curves.flat_punch(self.radius, depth, layer.length)
        factor = np.exp(change)
        force = base.force * factor
        by_thickness = (
            -(by_length * layer.length + by_confinement * self.radius) / layer.thickness**2
        )
        return LayerForceCurve(
            force,
            base.by_depth * factor,
            base.by_length * factor + force * by_length / layer.thickness,
            force * by_thickness,
        )


class _Nodes(NamedTuple):
    """Contacts of given radii, each of shape (k,); derivatives are those at the same radius."""

    depth: Array
    """δ [m]."""
    depth_by: tuple[Array, Array]
    """Derivatives of δ with respect to s and h."""
    log_force: Array
    """log(P/E*)."""
    log_force_by: tuple[Array, Array]
    """Derivatives of log(P/E*) with respect to s and h."""


def odd_chebyshev(t: Array) -> Array:
    """Return T₁, T₃, … at t of shape (n,), one in each column."""
    return np.asarray(chebyshev.chebvander(t, 2 * PROFILES - 1)[:, 1::2])


def poissons_ratio_at(z: Array) -> Array:
    """Return 0 ≤ ν ≤ ½ at −1 ≤ z ≤ 1; contacts on a thin layer are smooth in z."""
    ratio: Array = 0.5 * (1 + _SPREAD - _SPREAD * (1 + 1 / _SPREAD) ** ((1 - z) / 2))
    return ratio


def confinements(widest: float = _LAST, count: int = _COUNT) -> Array:
    """Return nodes a/h from 0, which is left out, to ``widest``."""
    steps = np.arange(1, count + 1) / count
    nodes: Array = CONFINEMENT_SCALE * np.expm1(steps * np.log1p(widest / CONFINEMENT_SCALE))
    return nodes


CONFINEMENTS = confinements()


@cache
def _odd_basis() -> tuple[Array, Array]:
    """Return points t, and the matrix from values there to coefficients of `odd_chebyshev`."""
    t = np.cos((2 * np.arange(PROFILES) + 1) * np.pi / (4 * PROFILES))
    return t, np.asarray(np.linalg.inv(odd_chebyshev(t)), dtype=np.float64)


def smooth_profile(radius: float, limit: float, abel_slope: Callable[[Array], Array]) -> Profile:
    """Return the profile of an indenter whose radius of curvature at the tip is ``radius`` [m]."""

    def coefficients(a: Array) -> Array:
        t, to_coefficients = _odd_basis()
        return abel_slope(np.outer(a, t)) @ to_coefficients.T

    shallow = partial(master_curves.paraboloid, radius)
    return Profile("smooth", limit, 0.5, 1 / radius, coefficients, shallow)


def cone_profile(half_angle: float) -> Profile:
    """Return the profile of a cone of α = ``half_angle`` [rad], h′ = (π/2) cot α."""
    slope = np.pi / 2 / np.tan(half_angle)

    def coefficients(a: Array) -> Array:
        return np.full((a.size, 1), slope)

    half_space = partial(master_curves.cone, half_angle)
    return Profile("pointed", np.inf, 1.0, slope, coefficients, half_space)


@cache
def _half_space(shape: Shape) -> Interpolant:
    """Return the interpolant over s/a of the columns that ``curve_tables.row`` describes."""
    return stretched_spline(
        HALF_SPACE_LENGTHS, table_in(FILE)[f"{shape}_half_space"], HALF_SPACE_SCALE
    )


@lru_cache(maxsize=16)
def _layer(shape: Shape, poissons_ratio: float) -> Interpolant:
    """Return the interpolant over s/h of the changes by a layer, of shape (n, a/h, columns)."""
    z = 1 - 2 * np.log1p((1 - 2 * poissons_ratio) / _SPREAD) / np.log1p(1 / _SPREAD)
    change = chebyshev.chebval(z, table_in(FILE)[f"{shape}_layer"])
    return stretched_spline(LENGTHS, change, LENGTH_SCALE)


@cache
def _confinement_splines() -> Interpolant:
    """Return the interpolant over a/h of values that are 1 at one node, in a column for each."""
    return stretched_spline(CONFINEMENTS, np.eye(CONFINEMENTS.size), CONFINEMENT_SCALE)


# A fit evaluates one layer at many tensions.
@lru_cache(maxsize=16)
def _weights(confinement: bytes) -> tuple[Array, Array]:
    """Return weights of the nodes in values at each a/h and in slopes, of shape (n, nodes)."""
    return _confinement_splines()(np.frombuffer(confinement))


def _changes(shape: Shape, layer: TensedLayer, confinement: Array) -> tuple[Array, Array, Array]:
    """Return the changes by a layer at each a/h, and their derivatives by s/h and by a/h."""
    length, last = layer.length / layer.thickness, float(LENGTHS[-1])
    change, by_length = _layer(shape, layer.poissons_ratio)(np.array([min(length, last)]))
    # Beyond the last node tension carries nearly all of the force; the change is kept constant.
    both = np.concatenate([change[0], by_length[0] * (length <= last)], axis=1)
    # Thick layers change force and depth in proportion to a/h.
    inside = np.maximum(confinement, CONFINEMENTS[0])
    share = (confinement / inside)[:, None]
    value, slope = (weights @ both for weights in _weights(inside.tobytes()))
    slope = np.where(share < 1, value / CONFINEMENTS[0], slope)
    value *= share
    changes, by_lengths = np.split(value, 2, axis=1)
    return changes, by_lengths, np.split(slope, 2, axis=1)[0]


def _radii(limit: float, thickness: float) -> Array:
    """Return contact radii [m], the denser the nearer to the end of the profile."""
    if limit == np.inf:
        return thickness * CONFINEMENTS
    widest = min(_LAST * thickness, _FILLED * limit)
    # Depth and force are smooth in ξ = log(a / (1 − a/L)), up to a = L.
    scale = thickness * confinements(widest / (1 - widest / limit) / thickness, _POINTS)
    radii: Array = scale / (1 + scale / limit)
    return radii


def _nodes(profile: Profile, layer: TensedLayer, a: Array) -> _Nodes:
    """Return the contacts of radii a [m], of shape (k,)."""
    length, thickness = layer.length, layer.thickness
    confinement = a / thickness
    base, base_rate = _half_space(profile.shape)(length / a)
    change, by_length, by_confinement = _changes(profile.shape, layer, confinement)
    value = base + change
    by = (
        base_rate / a[:, None] + by_length / thickness,
        -(length * by_length + a[:, None] * by_confinement) / thickness**2,
    )
    series = profile.coefficients(a)
    count = series.shape[1]

    def force(columns: Array, first: float) -> Array:
        total: Array = first * series[:, 0] + np.sum(series[:, 1:] * columns[:, 1:count], axis=1)
        return total

    def depth(columns: Array) -> Array:
        total: Array = a * np.sum(series * columns[:, count:], axis=1)
        return total

    share = force(value, 1.0)
    return _Nodes(
        depth(value),
        (depth(by[0]), depth(by[1])),
        2 * np.log(a) + value[:, 0] + np.log(share),
        (by[0][:, 0] + force(by[0], 0.0) / share, by[1][:, 0] + force(by[1], 0.0) / share),
    )


@lru_cache(maxsize=64)
def _splines(profile: Profile, layer: TensedLayer) -> tuple[BSpline, BSpline, float]:
    """Return the change of log P by the layer, its derivatives by s and h, and their last x."""
    from scipy.interpolate import make_interp_spline

    nodes = _nodes(profile, layer, _radii(profile.limit, layer.thickness))
    x, x_rate = profile.stretch(nodes.depth, layer.thickness)
    half_space = profile.half_space(nodes.depth, layer.length)

    def spline(values: Array) -> BSpline:
        # The change vanishes with the depth.
        padded = np.concatenate([np.zeros((1, *values.shape[1:])), values])
        return make_interp_spline(np.append(0.0, x), padded, 5)

    change = spline(nodes.log_force - np.log(half_space.force))
    slope = half_space.by_depth / half_space.force + x_rate * change(x, 1)
    by_length, by_thickness = (
        rate - slope * depth_rate
        for rate, depth_rate in zip(nodes.log_force_by, nodes.depth_by, strict=True)
    )
    by_length = by_length - half_space.by_length / half_space.force
    return change, spline(np.stack([by_length, by_thickness], axis=1)), float(x[-1])
