"""Contact of a rigid axisymmetric indenter with a half-space under surface tension.

``equation`` has the equation and its solution. This module compares two mesh levels
and determines the contact radius for a depth or a force.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.components import HasAbelSlope
from pellicle.errors import ConfigError, ConvergenceError

from .arguments import not_negative, positive, single
from .equation import (
    LEVELS,
    PanelSolution,
    solve,
    without_kinks,
    without_negligible,
)

TOLERANCE = 1e-10
EDGE_TOLERANCE = 1e-6


@dataclass(frozen=True)
class AxisymmetricContact:
    """Contact of a rigid axisymmetric indenter with a tensed half-space."""

    contact_radius: float
    """a [m]."""
    depth: float
    """δ [m]."""
    force: float
    """P [N]."""
    reduced_modulus: float
    """E* [Pa]."""
    tension: float
    """τ₀ [N/m]."""
    _solution: PanelSolution = field(repr=False, compare=False)

    def pressure(self, r: ArrayLike) -> Array:
        """Return the pressure [Pa] at r ≥ 0 [m], of any shape; 0 for r > a.

        At r = a it is the limit from inside, which is not 0 under tension.  Under a
        cone it is infinite at r = 0.
        """
        t = np.asarray(r, dtype=float) / self.contact_radius
        flat = np.abs(t).ravel()
        singular = (flat == 0) & (self._solution.power < 1)
        out = np.where(singular, np.inf, 0.0)
        regular = ~singular & (flat <= 1)
        out[regular] = self.reduced_modulus * self._solution.pressure(flat[regular])
        return out.reshape(t.shape)


def _contact(
    indenter: HasAbelSlope, reduced_modulus: float, tension: float, a: float
) -> AxisymmetricContact:
    ratio = without_negligible(2 * tension / reduced_modulus / a)
    change = np.array([np.inf])
    allowed = np.array([TOLERANCE, TOLERANCE, EDGE_TOLERANCE])
    old: Array | None = None
    for level in range(len(LEVELS)):
        solution = solve(indenter, a, ratio, level)
        edge = solution.pressure(np.ones(1))[0] if ratio else 1.0
        new = np.array([*solution.moments(), edge])
        if old is not None:
            change = np.abs(new / old - 1)
            if np.all(change <= allowed):
                depth, force = float(new[1]) * a, float(new[0]) * reduced_modulus * a**2
                return AxisymmetricContact(a, depth, force, reduced_modulus, tension, solution)
        old = new
    raise ConvergenceError(
        f"force, depth and edge pressure still change by {change} (allowed {allowed}) "
        f"at a = {a} m, s/a = {ratio:g}; is the contact too close to the end of the profile?"
    )


def indent(
    indenter: HasAbelSlope,
    reduced_modulus: float,
    tension: float,
    *,
    contact_radius: float | None = None,
    depth: float | None = None,
    force: float | None = None,
) -> AxisymmetricContact:
    """Return the contact of a rigid axisymmetric indenter for one of a [m], δ [m] or P [N].

    The indenter is a paraboloid, sphere or cone component, or any other object with
    `HasAbelSlope` and no kinks; E* = E / (1 − ν²) [Pa], and the tension τ₀ [N/m] may be zero.
    """
    without_kinks(indenter)
    positive(reduced_modulus=reduced_modulus)
    not_negative(tension=tension)
    quantity, value = single(contact_radius=contact_radius, depth=depth, force=force)
    positive(**{quantity: value})
    limit = indenter.contact_radius_limit
    if quantity == "contact_radius":
        a = value
        if a >= limit:
            raise ConfigError(f"contact radius {a} m must be less than {limit} m", quantity)
    else:
        target = value if quantity == "depth" else value / reduced_modulus
        a = _radius(indenter, 2 * tension / reduced_modulus, quantity, target)
    return _contact(indenter, reduced_modulus, tension, a)


def _radius(indenter: HasAbelSlope, s: float, quantity: str, target: float) -> float:
    """Return the contact radius [m] for a depth [m], or for a force over E* [m²]."""
    is_depth, limit = quantity == "depth", indenter.contact_radius_limit

    def excess(log_a: float, s: float = s) -> float:
        a = float(np.exp(log_a))
        moment = solve(indenter, a, without_negligible(s / a), 0).moments()[is_depth]
        return float(np.log(moment * a ** (2 - is_depth) / target))

    # Tension adds to force and depth, so a radius large enough without it is an upper bound.
    high = min(limit / 2, target if is_depth else target**0.5)
    while excess(np.log(high), 0.0) < 0:
        high = min(2 * high, (high + limit) / 2)
        if high > limit * (1 - 1e-9):
            raise ConfigError(
                f"needs a contact wider than {limit} m, the end of the profile", quantity
            )
    low = high = np.log(high)
    while (above := excess(low)) > 0:
        high, low = low, low - max(above / 2, 0.1)
    if low == high:
        return float(np.exp(high))
    # Outputs import this module, but most of them do not need scipy.optimize.
    from scipy.optimize import brentq

    return float(np.exp(brentq(excess, low, high, xtol=1e-14, rtol=1e-14)))
