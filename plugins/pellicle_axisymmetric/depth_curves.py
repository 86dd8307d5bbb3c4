"""Force over depth of any body of revolution under surface tension.

Contacts of given radii (``reciprocity``) are nodes of a spline of log F over log δ, beyond which
the force is a power of the depth: under a flat end a linear one.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.components import ForceCurve, HasAbelSlope

from .equation import kinks_of
from .radius_curves import END, radius_at
from .reciprocity import contacts, transform

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

_STEP = 0.1
"""Distance of nodes in ξ = log(a / (1 − a/L)), where L is the end of the profile."""
_COUNT, _ROUND = 160, 8
"""Nodes of a curve, and of how many the number of the last is a multiple."""
_FIRST, _LAST = -600, 200
"""Least and greatest number of a node: steep bodies would overflow beyond."""
_BESIDE: Array = np.geomspace(1e-6, 0.9, 60)
"""Distances of nodes from a kink on both sides, over its radius."""
_RISE = 1e-3
"""Least rise of the depth from node to node, over it, for slopes that are free of round-off."""
LEAST_DEPTH = 1e-60
"""[m]; powers of a depth at the end of the range of floats would overflow."""


def force_curve(body: HasAbelSlope, depth: Array, length: float) -> ForceCurve:
    """Return P/E* and its derivatives at depths [m], of shape (n,), for s = ``length`` [m]."""
    touches, d = contact_part(depth)
    curve = _curve(body, length, _last(body, float(d.max(initial=LEAST_DEPTH))))
    x = np.log(d)
    inside = np.clip(x, curve.t[0], curve.t[-1])
    log_force, log_stiffness, by_length = curve(inside).T
    power = np.exp(log_stiffness + inside - log_force)
    force = np.exp(log_force + power * (x - inside))
    return fill_curve(touches, force, force * power / d, force * by_length)


def stretch_curve(
    body: HasAbelSlope, width: float, height: float, depth: Array, length: float
) -> ForceCurve:
    """Return P/E* of a body stretched by ``width`` along radii and by ``height`` along the axis.

    All bodies that are stretched copies of one share its contacts.
    """
    force, by_depth, by_length = force_curve(body, depth / height, length / width)
    return ForceCurve(width * height * force, width * by_depth, height * by_length)


def contact_part(depth: Array) -> tuple[Mask, Array]:
    """Return where there is contact, and the depths there."""
    touches = depth > 0
    return touches, np.maximum(depth[touches], LEAST_DEPTH)


def fill_curve(touches: Mask, *values: Array) -> ForceCurve:
    """Return values known in contact as a curve that is 0 elsewhere."""
    out = np.zeros((3, touches.size))
    out[:, touches] = values
    return ForceCurve(*out)


def _last(body: HasAbelSlope, depth: float) -> int:
    """Return the number of a node that is as deep without tension [m], and beyond kinks."""
    radii, depths = _all(body)
    beyond = 2 * max(kinks_of(body), default=0.0)
    last = max(np.searchsorted(depths, depth), np.searchsorted(radii, beyond))
    # All from the end of the profile on are one.
    return int(min(-(-last // _ROUND) * _ROUND, np.searchsorted(radii, radii[-1])))


@lru_cache(maxsize=64)
def _all(body: HasAbelSlope) -> tuple[Array, Array]:
    """Return the radii of all nodes and their depths without tension [m]."""
    radii = _radii(body, _FIRST, _LAST)
    return radii, transform(body, radii)


def _radii(body: HasAbelSlope, first: int, last: int) -> Array:
    """Return the radii [m] of nodes, where the profile has not ended."""
    radius = radius_at(body, _STEP * np.arange(first, last, dtype=np.float64))
    radii: Array = np.minimum(radius, (1 - END) * body.contact_radius_limit)
    return radii


@lru_cache(maxsize=64)
def _nodes(body: HasAbelSlope, last: int) -> Array:
    """Return the radii [m] of nodes up to one, denser beside kinks."""
    radius = _radii(body, last + _FIRST - _COUNT, last + _FIRST + 1)
    beside = (kink * (1 + side * _BESIDE) for kink in kinks_of(body) for side in (-1, 1))
    near = np.concatenate([radius, *beside])
    return np.unique(near[(near >= radius[0]) & (near <= radius[-1])])


@lru_cache(maxsize=64)
def _curve(body: HasAbelSlope, length: float, last: int) -> BSpline:
    """Return log(P/E*), log(k/E*) and ∂ log P/∂s over log δ up to a node and beyond."""
    from scipy.interpolate import make_interp_spline

    states = contacts(body, _nodes(body, last), length)
    # Under a flat end there is no contact of less than its radius.
    touches = (states.depth > 0) & (states.force > 0)
    touches[1:] &= states.depth[1:] > (1 + _RISE) * np.maximum.accumulate(states.depth)[:-1]
    depth, force, stiffness, _, by_length = (part[touches] for part in states)
    values = np.column_stack([np.log(force), np.log(stiffness), by_length / force])
    return make_interp_spline(np.log(depth), values, 5)
