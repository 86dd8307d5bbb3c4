"""Contact without adhesion as smooth functions of the contact radius.

Force F₁, depth δ₁ and stiffness k of an axisymmetric contact on a tensed half-space are known at
Chebyshev nodes of ξ = log(a / (1 − a/L)), L being the end of the profile, on panels of length 2 in
ξ, and interpolated there.  The derivative of the interpolant of log k agrees to 1e-9, from
s/a = 1e-11 to 10, with the line load N [N/m] that a flat punch under tension carries at its rim,
k′ = 4πa N² / (2τ₀ δ²).
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from pellicle.arrays import Array
from pellicle.components import HasAbelSlope
from pellicle.errors import ConvergenceError

from .reciprocity import contacts

_PANEL = 2.0
_NODES = 14
TOLERANCE = 1e-9
END = 1e-6
"""Share of the profile's radius that stays free of contact."""


class RadiusCurves(NamedTuple):
    """Radius, and force, depth and stiffness with logarithmic derivatives in ξ, each of shape (n,).

    Forces are in units of E*, the reduced modulus.
    """

    radius: Array
    """a [m]."""
    radius_slope: Array
    """d log a / dξ = 1 − a/L."""
    force: Array
    """F₁/E* [m²]."""
    force_slope: Array
    """d log F₁ / dξ."""
    depth: Array
    """δ₁ [m]."""
    depth_slope: Array
    """d log δ₁ / dξ."""
    stiffness: Array
    """k/E* [m], of the flat punch of radius a."""
    stiffness_slope: Array
    """d log k / dξ."""
    stiffness_curvature: Array
    """d² log k / dξ²."""


def radius_at(indenter: HasAbelSlope, xi: Array) -> Array:
    """Return the contact radius [m] at ξ, of any shape."""
    scale = np.exp(xi)
    radius: Array = scale / (1 + scale / indenter.contact_radius_limit)
    return radius


def xi_at(indenter: HasAbelSlope, radius: Array) -> Array:
    """Return ξ at a contact radius [m] below the end of the profile, of any shape."""
    xi: Array = np.log(radius) - np.log1p(-radius / indenter.contact_radius_limit)
    return xi


def radius_curves(indenter: HasAbelSlope, length: float, xi: Array) -> RadiusCurves:
    """Return the contact without adhesion at ξ, of shape (n,), for s = ``length`` [m]."""
    index = np.floor(xi / _PANEL).astype(int)
    values = np.empty((3, 3, xi.size))
    for panel in np.unique(index):
        inside = index == panel
        t = 2 * (xi[inside] / _PANEL - panel) - 1
        series = _series(indenter, length, int(panel))
        for order in range(3):
            values[order][:, inside] = chebyshev.chebval(t, series) * (2 / _PANEL) ** order
            series = np.asarray(chebyshev.chebder(series), dtype=np.float64)
    (force, depth, stiffness), slopes, curvatures = values
    radius = radius_at(indenter, xi)
    return RadiusCurves(
        radius=radius,
        radius_slope=1 - radius / indenter.contact_radius_limit,
        force=np.exp(force),
        force_slope=slopes[0],
        depth=np.exp(depth),
        depth_slope=slopes[1],
        stiffness=np.exp(stiffness),
        stiffness_slope=slopes[2],
        stiffness_curvature=curvatures[2],
    )


@lru_cache(maxsize=128)
def _series(indenter: HasAbelSlope, length: float, panel: int) -> Array:
    """Return the Chebyshev coefficients of log F₁/E*, log δ₁ and log k/E*, shape (n, 3)."""
    nodes = chebyshev.chebpts1(_NODES)
    radii = radius_at(indenter, _PANEL * (panel + (nodes + 1) / 2))
    states = contacts(indenter, radii, length)
    rows = np.log(np.column_stack([states.force, states.depth, states.stiffness]))
    series = np.asarray(chebyshev.chebfit(nodes, rows, _NODES - 1), dtype=np.float64)
    error = np.abs(series[-2:]).max()
    if not error <= TOLERANCE:
        raise ConvergenceError(
            f"force, depth and stiffness at contact radii from {radii[0]:.3g} to {radii[-1]:.3g} m "
            f"are known to {error:.1g} only (allowed {TOLERANCE:g}); is the profile smooth there?"
        )
    return series
