"""Adhesive contact of a paraboloid with a half-space without tension, for a force of finite range.

Around the contact, of radius a, the surfaces attract each other with a constant traction σ₀ up to
the gap w/σ₀ at the radius c (Dugdale; Maugis 1992).  One parameter λ goes from 0, a stiff solid or
a long range (Derjaguin, Muller & Toporov 1975), to ∞, the limit of Johnson, Kendall & Roberts
(1971).
"""

from __future__ import annotations

from math import cbrt, pi, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.errors import ConfigError

from .arguments import positive


class DugdaleContact(NamedTuple):
    """Contacts with a Dugdale zone, arrays of the shape of the contact radii."""

    contact_radius: Array
    """a [m]."""
    zone_radius: Array
    """c [m], where the attraction ends."""
    depth: Array
    """δ [m]."""
    force: Array
    """F [N], negative where the indenter is pulled."""


def transition_parameter(
    radius: float, reduced_modulus: float, work_of_adhesion: float, strength: float
) -> float:
    """Return λ = 2σ₀ (R / πwK²)^(1/3), K = 4E*/3 (Maugis 1992).

    R is the radius [m], E* = E / (1 − ν²) [Pa], w [J/m²] and σ₀ [Pa] the strength.
    """
    positive(
        radius=radius,
        reduced_modulus=reduced_modulus,
        work_of_adhesion=work_of_adhesion,
        strength=strength,
    )
    k = 4 / 3 * reduced_modulus
    return 2 * strength * cbrt(radius / (pi * work_of_adhesion * k**2))


def dugdale_contact(
    radius: float,
    reduced_modulus: float,
    work_of_adhesion: float,
    strength: float,
    contact_radius: ArrayLike,
) -> DugdaleContact:
    """Return the equilibria, stable or not, of contact radii a ≥ 0 [m] of any shape.

    At a = 0 the surfaces touch in a point; the others are as for `transition_parameter`.
    """
    transition = transition_parameter(radius, reduced_modulus, work_of_adhesion, strength)
    a = np.asarray(contact_radius, dtype=float)
    if not np.all((a >= 0) & np.isfinite(a)):
        raise ConfigError(f"must not be negative, got {contact_radius!r}", "contact_radius")
    unit = cbrt(pi * work_of_adhesion * radius**2 / (4 / 3 * reduced_modulus))
    scaled = a / unit
    angles = np.array([_zone_angle(float(ratio), transition) for ratio in scaled.ravel()])
    angle = angles.reshape(a.shape)
    touching = scaled > 0
    # The point contact has an infinite ratio c/a, but a finite c.
    linear = 4 / 3 * (pi / 2 - 1) * transition**2
    point_zone = 2 / (linear + sqrt(linear**2 + 4 * (pi / 4 * transition)))
    zone = np.where(touching, scaled / np.cos(angle), point_zone)
    width = np.where(touching, scaled * np.tan(angle), zone)
    force = scaled**3 - transition * (scaled * width + zone**2 * angle)
    depth = scaled**2 - 4 / 3 * transition * width
    return DugdaleContact(
        contact_radius=a,
        zone_radius=unit * zone,
        depth=unit**2 / radius * depth,
        force=pi * work_of_adhesion * radius * force,
    )


def _zone_angle(radius: float, transition: float) -> float:
    """Return θ = arccos(a/c), at which the gap at c is w/σ₀ (Maugis 1992).

    ``radius`` is in units of (πwR²/K)^(1/3).
    """
    if not radius:
        return pi / 2
    # scipy.optimize takes long to import, and outputs import neighbours of this module.
    from scipy.optimize import brentq

    def excess(log_tangent: float) -> float:
        tangent = np.exp(log_tangent)
        secant, angle = np.hypot(1, tangent), np.arctan(tangent)
        shape = tangent + (secant**2 - 2) * angle
        # sec θ − 1 = tan² θ / (1 + sec θ) does not cancel.
        pull = angle * tangent - tangent**2 / (1 + secant)
        return float(transition * radius**2 / 2 * shape + 4 / 3 * transition**2 * radius * pull - 1)

    low = high = 0.0
    while excess(high) < 0:
        high += 1
    while excess(low) > 0:
        low -= 1
    return float(np.arctan(np.exp(brentq(excess, low, high, xtol=1e-14, rtol=1e-14))))
