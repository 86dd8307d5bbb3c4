"""Force against depth under surface tension, interpolated between exact solutions.

By dimensional analysis only few variables remain.  With s = 2τ₀/E* and the force without tension
P₀(δ), log(P/P₀) is a function of x alone for three of the indenters:

- paraboloid, x = s / √(δR), P₀ = (4/3) E* R^(1/2) δ^(3/2);
- cone, x = s cot α / δ, P₀ = (2/π) E* tan α δ²;
- flat punch, x = s / a, P₀ = 2 E* a δ.

For the sphere it is a function of x = s / √(δR) and δ/R: that of the paraboloid plus (δ/R) times a
smooth function, tabulated for δ ≤ R.  The nodes are solutions of the axisymmetric equation
(``docs/reference-data/curve_tables.py``), interpolated by a spline of degree 5 in
t = log(1 + x/SCALE), which is linear in x where tension hardly matters and logarithmic where it
dominates.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from pellicle.arrays import Array, Mask
from pellicle.components import ContactRadius, ForceCurve

from .stretched_spline import Interpolant, stretched_spline, with_slopes

SCALE = 1e-3
_PUNCH_RADII: tuple[float, float] = 1e-3, 1e8
"""Least and largest radius of a punch over s at which its stiffness is inverted."""
LEAST_DEPTH = 1e-60
"""[m]; powers of a depth at the end of the range of floats would overflow."""
FILE = files("pellicle_plugins.axisymmetric").joinpath("master_curves.json")


@cache
def _table() -> dict[str, Any]:
    table: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))
    return table


def one_variable(nodes: Mapping[str, Sequence[float]]) -> Interpolant:
    """Return the interpolant of ``x`` and ``log_ratio``; beyond the last x it is a power law."""
    return stretched_spline(nodes["x"], nodes["log_ratio"], SCALE)


@cache
def _one_variable(name: str) -> Interpolant:
    return one_variable(_table()[name])


@cache
def _sphere_coefficients() -> tuple[float, Any]:
    """Return the last t; Chebyshev coefficients of values, slopes in δ/R and d/dt of values.

    Each has as many, those of the slopes a last one of 0.
    """
    from scipy.interpolate import PPoly

    nodes = _table()["sphere"]
    t = np.log1p(np.asarray(nodes["x"]) / SCALE)
    values = np.asarray(nodes["coefficients"])
    slopes = np.zeros_like(values)
    slopes[:, :-1] = 2 * np.asarray(chebyshev.chebder(values, axis=1))
    both = with_slopes(t, np.concatenate([values, slopes], axis=1))
    used = 3 * values.shape[1]
    return float(t[-1]), PPoly(both.c[..., :used].copy(), both.x)


def paraboloid(radius: float, depth: Array, length: float) -> ForceCurve:
    """Return P/E* under a paraboloid of R = ``radius`` [m] at s = ``length`` [m]."""
    touching, d = _touching(depth)
    return _spread(touching, *_paraboloid(radius, d, length))


def _paraboloid(radius: float, d: Array, length: float) -> ForceCurve:
    """Return P/E* under a paraboloid at depths > 0 [m]."""
    root = np.sqrt(d * radius)
    x = _ratio(length, root)
    log, rate = _one_variable("paraboloid")(x)
    force = 4 / 3 * np.sqrt(radius) * d**1.5 * np.exp(log)
    return ForceCurve(force, force / d * (1.5 - rate * x / 2), force * rate / root)


def cone(half_angle: float, depth: Array, length: float) -> ForceCurve:
    """Return P/E* under a cone of α = ``half_angle`` [rad] at s = ``length`` [m]."""
    touching, d = _touching(depth)
    tangent = np.tan(half_angle)
    x = _ratio(length, tangent * d)
    log, rate = _one_variable("cone")(x)
    force = 2 / np.pi * tangent * d**2 * np.exp(log)
    by_depth = force / d * (2 - rate * x)
    return _spread(touching, force, by_depth, force * rate / (tangent * d))


def flat_punch(radius: float, depth: Array, length: float) -> ForceCurve:
    """Return P/E* under a flat punch of a = ``radius`` [m] at s = ``length`` [m]."""
    touching, d = _touching(depth)
    log, rate = _one_variable("flat_punch")(np.array([length / radius]))
    stiffness = 2 * radius * np.exp(log)
    force = stiffness * d
    return _spread(touching, force, np.full_like(d, stiffness[0]), force * rate / radius)


def punch_radius(stiffness: Array, length: float) -> ContactRadius:
    """Return the radius [m] of flat punches of stiffnesses k/E* [m] at s = ``length`` [m]."""
    if not length:
        return ContactRadius(stiffness / 2, np.full_like(stiffness, 2.0))
    first, last, inverse = _punch_radii()
    size = np.log(stiffness / length)
    # Beyond the last node tension changes nothing.
    radius = np.where(size < last, length * np.exp(inverse(np.clip(size, first, last))), 0.0)
    radius = np.where(size < last, radius, stiffness / 2)
    ratio = length / radius
    log, rate = _one_variable("flat_punch")(ratio)
    return ContactRadius(radius, 2 * np.exp(log) * (1 - ratio * rate))


@cache
def _punch_radii() -> tuple[float, float, Any]:
    """Return log(a/s) of a flat punch as a function of log(k/s), between the first and the last."""
    from scipy.interpolate import make_interp_spline

    radii = np.log(np.geomspace(*_PUNCH_RADII, 600))
    log, _ = _one_variable("flat_punch")(np.exp(-radii))
    size = np.log(2.0) + radii + log
    return float(size[0]), float(size[-1]), make_interp_spline(size, radii, 5)


def sphere(radius: float, depth: Array, length: float) -> ForceCurve:
    """Return P/E* under a sphere of R = ``radius`` [m] at s = ``length`` [m].

    It is valid up to δ = R; beyond, the contribution of the shape to log P is kept constant.
    """
    touching, d = _touching(depth)
    flat = _paraboloid(radius, d, length)
    last, spline = _sphere_coefficients()
    root = np.sqrt(d * radius)
    x = _ratio(length, root)
    at = np.log1p(x / SCALE)
    inside = np.minimum(at, last)
    ratio = np.minimum(d / radius, 1.0)
    together = spline(inside)
    count = together.shape[1] // 3
    coefficients = together.reshape(inside.size, 3, count)
    polynomials = chebyshev.chebvander(2 * ratio - 1, count - 1)
    shape, by_ratio, by_t = np.einsum("ikj,ij->ki", coefficients, polynomials)
    by_x = np.where(at < last, by_t, 0.0) / (x + SCALE)
    factor = np.exp(ratio * shape)
    force = flat.force * factor
    grows = np.where(d < radius, (shape + ratio * by_ratio) / radius, 0.0)
    by_depth = flat.by_depth * factor + force * (grows - ratio * by_x * x / (2 * d))
    by_length = flat.by_length * factor + force * ratio * by_x / root
    return _spread(touching, force, by_depth, by_length)


def _ratio(length: float, sizes: Array) -> Array:
    """Return s over other lengths; a single 0 without tension, where one spline value serves all.

    Splines are most of the cost of a force curve.
    """
    ratio: Array = length / sizes if length else np.zeros(1)
    return ratio


def _touching(depth: Array) -> tuple[Mask, Array]:
    """Return where there is contact, and the depths there."""
    touching = depth > 0
    return touching, np.maximum(depth[touching], LEAST_DEPTH)


def _spread(touching: Mask, *values: Array) -> ForceCurve:
    """Return values known in contact as a curve that is 0 elsewhere."""
    out = np.zeros((3, touching.size))
    out[:, touching] = values
    return ForceCurve(*out)
