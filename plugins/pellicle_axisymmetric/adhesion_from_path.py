"""The adhesive contact of any axisymmetric indenter on any kernel, from a path without adhesion."""

from __future__ import annotations

from math import inf, nan, pi
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.errors import ConfigError

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

STEPS = 8
"""Fewest steps of a path."""
_STEPS_PER_PIECE = 3
"""Steps between two knots of a spline."""
_POINTS_PER_STEP = 32
"""Points of a curve for each step."""
_SCATTER = 1e-3
"""Relative difference of stiffness and slope up to which a point counts as on the path."""
_FLAT = 0.03
"""Relative difference of F/δ and stiffness up to which a step touches a flat end alone: that of a
contact half a cell wider than a flat with ten cells in its radius."""
_BESIDE = 1.1
"""Radius over that of an edge below which the spline, of few steps there, is not used."""


class AdhesiveContact(NamedTuple):
    """An adhesive contact in equilibrium; numbers, or arrays of one shape."""

    contact_radius: Array
    """a [m]."""
    depth: Array
    """δ [m]."""
    force: Array
    """F [N], negative where the indenter is pulled."""


class AdhesiveCurve(AdhesiveContact):
    """Adhesive equilibria, stable or not, by growing contact radius; arrays of shape (n,).

    Two points of one radius are the ends of a straight piece, on which an edge pins the rim.
    """

    def instability(self, spring_constant: float = 0.0) -> AdhesiveContact:
        """Return the last stable equilibrium of a retraction, where dF/dδ = −k_c.

        k_c = ``spring_constant`` [N/m] is that of what holds the indenter.  0, the default, is a
        dead load: pull-off, the lowest force.  ``math.inf`` is a fixed depth: the lowest depth.
        At an edge it is where the punch of that radius lets go.  All is NaN if the curve does not
        contain it.
        """
        if not spring_constant >= 0:
            raise ConfigError(f"must not be negative, got {spring_constant!r}", "spring_constant")
        fixed_quantity = (
            self.depth if spring_constant == inf else self.force + spring_constant * self.depth
        )
        rises, pinned = np.diff(fixed_quantity) >= 0, np.diff(self.contact_radius) == 0
        minima = np.flatnonzero(np.append(pinned[:1], ~rises[:-1]) & rises)
        # A contact that jumps at a minimum may be held at a lower one, or beyond the last radius.
        lowest = int(minima[fixed_quantity[minima].argmin()]) if minima.size else -1
        if fixed_quantity[lowest] >= fixed_quantity[-1]:
            return AdhesiveContact(*np.full(3, nan))
        if pinned[lowest]:
            return AdhesiveContact(*(np.asarray(y[lowest]) for y in self))
        # The vertex of the parabola through the lowest point and its neighbours.
        near = slice(lowest - 1, lowest + 2)
        low, centre, high = fixed_quantity[near]
        offset = (low - high) / (2 * (low - 2 * centre + high))
        return AdhesiveContact(
            *(
                np.asarray(
                    centre + offset * (high - low) / 2 + offset**2 * (low - 2 * centre + high) / 2
                )
                for low, centre, high in (y[near] for y in self)
            )
        )

    def at_zero_load(self) -> AdhesiveContact:
        """Return the largest contact that is neither pressed nor pulled; NaN if there is none."""
        return self.at("force", 0.0)

    def at(self, quantity: str, value: float) -> AdhesiveContact:
        """Return the largest contact at a rising depth [m] or force [N]; NaN if there is none."""
        values = getattr(self, quantity) - value
        rising = np.flatnonzero((values[:-1] < 0) & (values[1:] >= 0))
        if not rising.size:
            return AdhesiveContact(*np.full(3, nan))
        low = int(rising[-1])
        share = values[low] / (values[low] - values[low + 1])
        return AdhesiveContact(*(np.asarray(y[low] + share * (y[low + 1] - y[low])) for y in self))


def adhesive_curve(
    depth: ArrayLike,
    force: ArrayLike,
    contact_radius: ArrayLike,
    stiffness: ArrayLike,
    work_of_adhesion: float,
) -> AdhesiveCurve:
    """Return the adhesive contact of an axisymmetric indenter from its contact without adhesion.

    With force F₁, depth δ₁ and stiffness k = dF₁/dδ₁ without adhesion at contact radius a, the
    adhesive contact is that contact and a flat punch retracted by D:

        F = F₁ − kD,  δ = δ₁ − D,  D² = 4πa w / (dk/da) = 2w d(πa²)/dk,

    where the energy release rate equals the work of adhesion w.  This holds for every linear
    kernel; on a half-space it is the theory of Johnson, Kendall & Roberts (1971).

    F₁ is a cubic spline of the depth, k its slope, and a a cubic spline of the measured k, each
    fitted in logarithms with a knot at every third step.  On a grid both the radius and the
    stiffness of a step change in steps of whole cells, but together: the radius as a function of
    the stiffness has a tenth of the scatter that it has as a function of the depth.

    Of an indenter with a flat end the shallowest steps touch that alone, F₁ = kδ₁.  Its edge pins
    the rim of an adhesive contact until the flat punch lets go, at δ = −D with the D of its radius;
    dk/da there, from a parabola of log a over log k, is within some per cent.

    The steps have δ₁ [m], F₁ [N], a [m] and k [N/m], positive, in any order, each of shape (n,); w
    is in J/m². On a grid the area of cells overestimates a by 0.115 cells on a half-space, by 0.24
    under tension.

    Raises
    ------
    pellicle.errors.ConfigError
        Fewer than eight steps differ in depth or in radius, a number is not positive, or radius and
        stiffness do not grow with the depth.
    """
    if not 0 < work_of_adhesion < inf:
        raise ConfigError(
            f"must be positive and finite, got {work_of_adhesion!r}", "work_of_adhesion"
        )
    columns = depth, force, contact_radius, stiffness
    path = np.stack([np.asarray(values, dtype=np.float64) for values in columns])
    if not np.all((path > 0) & np.isfinite(path)):
        raise ConfigError("depth, force, contact radius and stiffness must be positive", "path")
    # Steps with the same depth count once.
    path = np.log(path[:, np.unique(path[0], return_index=True)[1]])
    on_flat = int(np.argmin(np.append(np.abs(path[1] - path[0] - path[3]) < _FLAT, False)))
    force_by_depth = _spline(path[0], path[1], np.exp(2 * path[2]), "depth")
    # Steps with the same cells in contact have the same stiffness but for rounding.
    distinct = path[:, np.unique(path[2], return_index=True)[1]]
    distinct = distinct[:, np.argsort(distinct[3])]
    radius_by_stiffness = _spline(distinct[3], distinct[2], np.exp(distinct[2]), "contact radius")

    steps = path.shape[1]
    between = np.linspace(0, steps - 1, _POINTS_PER_STEP * (steps - 1) + 1)
    log_depth = np.interp(between, np.arange(steps), path[0])
    hard_depth, hard_force = np.exp(log_depth), np.exp(force_by_depth(log_depth))
    slope = hard_force / hard_depth * force_by_depth.derivative()(log_depth)
    lowest, highest = np.exp(distinct[3, [0, -1]])
    # The slope of the force and the measured stiffness differ by 3e-4 on a grid.
    in_range = (slope >= lowest * (1 - _SCATTER)) & (slope <= highest * (1 + _SCATTER))
    hard_depth, hard_force, slope = hard_depth[in_range], hard_force[in_range], slope[in_range]
    log_slope = np.log(slope)
    radius = np.exp(radius_by_stiffness(log_slope))
    growth = radius_by_stiffness.derivative()(log_slope)
    # The smallest contacts, of few cells, may scatter too much.
    falling = np.flatnonzero((np.diff(radius, prepend=0.0) <= 0) | (growth <= 0))
    first = int(falling[-1]) + 1 if falling.size else 0
    edge = np.zeros((3, 0))
    if on_flat:
        edge = _pinned(distinct, np.exp(path[0, on_flat - 1]), work_of_adhesion)
        first = max(first, int(np.count_nonzero(radius <= _BESIDE * edge[0, 0])))
    if radius.size < (first + 2 if on_flat else 2 * (first + 1)):
        raise ConfigError(
            "the contact radius does not grow with the depth, or the stiffness not with the radius",
            "path",
        )
    retraction = radius[first:] * np.sqrt(
        4 * pi * work_of_adhesion * growth[first:] / slope[first:]
    )
    beyond = hard_depth[first:] - retraction, hard_force[first:] - slope[first:] * retraction
    return AdhesiveCurve(*np.hstack([edge, [radius[first:], *beyond]]))


def _pinned(distinct: Array, depth: float, work_of_adhesion: float) -> Array:
    """Return radius, depth and force where the edge of a flat lets go, and where it is left.

    ``distinct`` has the logarithms of a path by stiffness, the flat first, which touches alone up
    to a ``depth`` [m] without adhesion.
    """
    relative = distinct[3] - distinct[3, 0]
    _, growth, log_radius = np.polyfit(relative, distinct[2], 2)
    radius, stiffness = np.exp(log_radius), np.exp(distinct[3, 0])
    end = -radius * np.sqrt(4 * pi * work_of_adhesion * growth / stiffness)
    depths = np.array([end, end + depth])
    return np.array([np.full(2, radius), depths, stiffness * depths])


def _spline(x: Array, y: Array, weights: Array, name: str) -> BSpline:
    """Return a cubic spline through weighted points, with a knot at every third."""
    # Most outputs need no splines, and scipy.interpolate takes long to import.
    from scipy.interpolate import make_lsq_spline

    if x.size < STEPS:
        raise ConfigError(
            f"has {x.size} steps that differ in {name}; give at least {STEPS}", "path"
        )
    pieces = x.size // _STEPS_PER_PIECE
    knots = np.interp(np.linspace(0, x.size - 1, pieces + 1), np.arange(x.size), x)
    padded = np.pad(knots, 3, mode="edge")
    return make_lsq_spline(x, y, padded, w=weights)
