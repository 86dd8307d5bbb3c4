"""Contact of a rigid axisymmetric indenter with a half-space under surface tension.

The equation and its solution are in ``axisymmetric_equation``; here two mesh levels
are compared, and contact radius, depth or force may be the quantity given.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.errors import ConfigError, ConvergenceError

from .axisymmetric_equation import (
    LEVELS,
    Solution,
    solve,
    without_negligible,
)
from .axisymmetric_indenters import Indenter, classical_radius
from .checks import exactly_one, not_negative, positive

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
    _solution: Solution = field(repr=False, compare=False)

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
    indenter: Indenter, reduced_modulus: float, tension: float, a: float
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
                force, depth = float(new[0]), float(new[1])
                return AxisymmetricContact(
                    contact_radius=a,
                    depth=depth * a,
                    force=force * reduced_modulus * a**2,
                    reduced_modulus=reduced_modulus,
                    tension=tension,
                    _solution=solution,
                )
        old = new
    raise ConvergenceError(
        f"force, depth and edge pressure still change by {change} (allowed {allowed}) "
        f"at a = {a} m, s/a = {ratio:g}; is the contact too close to the end of the profile?"
    )


def indent(
    indenter: Indenter,
    reduced_modulus: float,
    tension: float,
    *,
    contact_radius: float | None = None,
    depth: float | None = None,
    force: float | None = None,
) -> AxisymmetricContact:
    """Return the contact of a rigid axisymmetric indenter, one quantity being given.

    Parameters
    ----------
    indenter
        ``Paraboloid``, ``Sphere``, ``Cone`` or anything else with their methods.
    reduced_modulus
        E* = E / (1 − ν²) [Pa].
    tension
        τ₀ [N/m], zero included.
    contact_radius, depth, force
        a [m], δ [m] or P [N].

    Raises
    ------
    pellicle.errors.ConvergenceError
        If two resolutions differ by more than 1e-10 in force or depth, or 1e-6 in
        edge pressure.
    """
    positive(reduced_modulus=reduced_modulus)
    not_negative(tension=tension)
    exactly_one(contact_radius=contact_radius, depth=depth, force=force)
    if contact_radius is not None:
        positive(contact_radius=contact_radius)
        a = contact_radius
    elif depth is not None:
        positive(depth=depth)
        a = _radius(indenter, 2 * tension / reduced_modulus, 1, depth)
    else:
        assert force is not None
        positive(force=force)
        a = _radius(indenter, 2 * tension / reduced_modulus, 0, force / reduced_modulus)
    if a >= indenter.limit:
        raise ConfigError(
            f"contact radius {a} m must be less than {indenter.limit} m", "contact_radius"
        )
    return _contact(indenter, reduced_modulus, tension, a)


def _radius(indenter: Indenter, s: float, quantity: int, target: float) -> float:
    """Return the contact radius of a force over E* (quantity 0) or depth (1)."""

    def excess(log_a: float) -> float:
        a = float(np.exp(log_a))
        moment = solve(indenter, a, without_negligible(s / a), 0).moments()[quantity]
        return float(np.log(moment * a ** (2 - quantity) / target))

    # Tension adds to force and depth, so the radius without it is an upper bound.
    high = np.log(classical_radius(indenter, quantity, target))
    above = excess(high)
    if above <= 0:
        return float(np.exp(high))
    low = high
    below = above
    while below > 0:
        high, low = low, low - max(below / 2, 0.1)
        below = excess(low)
    # Here, not above: outputs load this module, and draw without it.
    from scipy.optimize import brentq

    return float(np.exp(brentq(excess, low, high, xtol=1e-14, rtol=1e-14)))
