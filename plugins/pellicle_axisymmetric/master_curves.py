"""Force against depth under surface tension of bodies without a length of their own.

By dimensional analysis log(P/P₀), with the force P₀(δ) without tension and s = 2τ₀/E*, is a
function of x alone for three of the indenters:

- paraboloid, x = s / √(δR), P₀ = (4/3) E* R^(1/2) δ^(3/2);
- cone, x = (π/2) s cot α / δ, P₀ = (2/π) E* tan α δ²;
- flat punch, x = s / a, P₀ = 2 E* a δ.

Contacts of given radii (``reciprocity``) are nodes of a spline of degree 5 in t = log(1 + x/SCALE),
which is linear in x where tension hardly matters and logarithmic where it dominates.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle.components import ContactRadius, ForceCurve

from .depth_curves import contact_part, fill_curve
from .reciprocity import contacts, punch_slope, punch_stiffness
from .splines import Interpolant, stretched_spline

SCALE = 1e-3
_LENGTHS: Array = SCALE * np.expm1(np.arange(0.15, 23.1, 0.15))
"""s over the contact radius at the nodes."""
_PUNCH_RADII: tuple[float, float] = 1e-3, 1e8
"""Least and largest radius of a punch over s at which its stiffness is inverted."""


class _Power(NamedTuple):
    """A body with h = x^exponent."""

    exponent: int
    contact_radius_limit: float = np.inf
    pointed: bool = False

    def abel_slope(self, x: Array) -> Array:
        """Return h'(x)."""
        return np.asarray(self.exponent * x ** (self.exponent - 1))


@cache
def _one_variable(exponent: int) -> Interpolant:
    """Return log(P/P₀) of the body h = x^exponent over s / δ^(1/exponent)."""
    states = contacts(_Power(exponent), 1 / _LENGTHS, 1.0)
    # Without tension F = 2 E* (1 − 1/(exponent + 1)) δ^(1 + 1/exponent).
    root = states.depth ** (1 / exponent)
    classical = 2 * exponent / (exponent + 1) * states.depth * root
    x, log_ratio = 1 / root, np.log(states.force / classical)
    return stretched_spline(np.append(0.0, x), np.append(0.0, log_ratio), SCALE)


def paraboloid(radius: float, depth: Array, length: float) -> ForceCurve:
    """Return P/E* under a paraboloid of R = ``radius`` [m] at s = ``length`` [m]."""
    touches, d = contact_part(depth)
    root = np.sqrt(d * radius)
    x = _ratio(length, root)
    log, rate = _one_variable(2)(x)
    force = 4 / 3 * np.sqrt(radius) * d**1.5 * np.exp(log)
    return fill_curve(touches, force, force / d * (1.5 - rate * x / 2), force * rate / root)


def cone(half_angle: float, depth: Array, length: float) -> ForceCurve:
    """Return P/E* under a cone of α = ``half_angle`` [rad] at s = ``length`` [m]."""
    touches, d = contact_part(depth)
    radius = 2 / np.pi * np.tan(half_angle) * d
    x = _ratio(length, radius)
    log, rate = _one_variable(1)(x)
    force = radius * d * np.exp(log)
    return fill_curve(touches, force, force / d * (2 - rate * x), force * rate / radius)


def flat_punch(radius: float, depth: Array, length: float) -> ForceCurve:
    """Return P/E* under a flat punch of a = ``radius`` [m] at s = ``length`` [m]."""
    touches, d = contact_part(depth)
    log, rate = punch_stiffness(np.array([length / radius]))
    stiffness = 2 * radius * np.exp(log)
    force = stiffness * d
    return fill_curve(touches, force, np.full_like(d, stiffness[0]), force * rate / radius)


def punch_radius(stiffness: Array, length: float | Array) -> ContactRadius:
    """Return the radius [m] of flat punches of stiffnesses k/E* [m] at s = ``length`` [m]."""
    if not np.any(length):
        return ContactRadius(stiffness / 2, np.full_like(stiffness, 2.0))
    first, last, inverse = _punch_radii()
    size = np.log(stiffness / length)
    # Beyond the last node tension changes nothing.
    radius = np.where(size < last, length * np.exp(inverse(np.clip(size, first, last))), 0.0)
    radius = np.where(size < last, radius, stiffness / 2)
    return ContactRadius(radius, punch_slope(length / radius))


@cache
def _punch_radii() -> tuple[float, float, Any]:
    """Return log(a/s) of a flat punch as a function of log(k/s), between the first and the last."""
    from scipy.interpolate import make_interp_spline

    radii = np.log(np.geomspace(*_PUNCH_RADII, 600))
    log, _ = punch_stiffness(np.exp(-radii))
    size = np.log(2.0) + radii + log
    return float(size[0]), float(size[-1]), make_interp_spline(size, radii, 5)


def _ratio(length: float, sizes: Array) -> Array:
    """Return s over other lengths; a single 0 without tension, where one spline value serves all.

    Splines are most of the cost of a force curve.
    """
    ratio: Array = length / sizes if length else np.zeros(1)
    return ratio
