"""Hertz contact of a paraboloid, and of a quadric with two radii of curvature.

Hertz (1882), as in Johnson, Contact Mechanics (1985), eqs (4.22)–(4.24) for the
circular contact and section 4.2 for the elliptic one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import elliprd, elliprf

from pellicle.arrays import Array
from pellicle_axisymmetric import positive, single


@dataclass(frozen=True)
class HertzContact:
    """Elliptic (or circular) contact without tension."""

    semi_x: float
    """Semi-axis along x [m]; the contact radius if the contact is circular."""
    semi_y: float
    """Semi-axis along y [m]."""
    depth: float
    """Approach δ [m]."""
    force: float
    """Normal force [N]."""
    peak_pressure: float
    """Pressure at the centre [Pa]."""

    def pressure(self, x: ArrayLike, y: ArrayLike = 0.0) -> Array:
        """Return the pressure [Pa] at x, y [m] of broadcastable shapes; 0 outside."""
        across = np.asarray(x, dtype=float) / self.semi_x if self.semi_x else np.inf
        along = np.asarray(y, dtype=float) / self.semi_y if self.semi_y else np.inf
        return np.asarray(self.peak_pressure * np.sqrt(np.maximum(0.0, 1 - across**2 - along**2)))


def sphere(
    radius: float,
    reduced_modulus: float,
    *,
    depth: float | None = None,
    force: float | None = None,
    contact_radius: float | None = None,
) -> HertzContact:
    """Return the contact of a paraboloid r² / 2R for one given quantity.

    a² = R δ, F = 4 E* a³ / 3R, p₀ = 2 E* a / πR, with δ, a and R in m, F in N and E* = E / (1 − ν²)
    in Pa.
    """
    positive(radius=radius, reduced_modulus=reduced_modulus)
    quantity, a = single(depth=depth, force=force, contact_radius=contact_radius)
    if quantity == "depth":
        a = float(np.sqrt(radius * a))
    elif quantity == "force":
        a = float(np.cbrt(3 * a * radius / (4 * reduced_modulus)))
    return HertzContact(
        semi_x=a,
        semi_y=a,
        depth=a**2 / radius,
        force=4 * reduced_modulus * a**3 / (3 * radius),
        peak_pressure=2 * reduced_modulus * a / (np.pi * radius),
    )


def aspect_ratio(radius_ratio: float) -> float:
    """Return the ratio b / a ≤ 1 of the semi-axes for a ratio R_min / R_max ≤ 1.

    With the complete elliptic integrals K = B + D, D = (K − E) / k² of modulus
    k² = 1 − b²/a² the ratio solves R_min / R_max = (b/a)² D / B (Johnson 1985,
    section 4.2).  D is Carlson's R_D(0, b²/a², 1) / 3, which does not cancel at k = 0.
    """
    from scipy.optimize import brentq

    if radius_ratio == 1:
        return 1.0

    def mismatch(log_aspect: float) -> float:
        square = float(np.exp(2 * log_aspect))
        d = float(elliprd(0, square, 1)) / 3
        b = float(elliprf(0, square, 1)) - d
        return 2 * log_aspect + float(np.log(d / b / radius_ratio))

    return float(np.exp(brentq(mismatch, 2 * np.log(radius_ratio), 0.0, xtol=1e-15, rtol=1e-14)))


def ellipse(
    radius_x: float,
    radius_y: float,
    reduced_modulus: float,
    *,
    depth: float | None = None,
    force: float | None = None,
) -> HertzContact:
    """Return the contact of a quadric x² / 2R_x + y² / 2R_y for δ [m] or F [N].

    R_x and R_y are in m, E* = E / (1 − ν²) in Pa.  With the major semi-axis a along the larger
    radius R, δ = a² K / (2 R D), F = π E* a³ / (3 R D) and p₀ = 3F / (2π a b) (from Johnson 1985,
    section 4.2).
    """
    positive(radius_x=radius_x, radius_y=radius_y, reduced_modulus=reduced_modulus)
    quantity, value = single(depth=depth, force=force)
    larger, smaller = max(radius_x, radius_y), min(radius_x, radius_y)
    aspect = aspect_ratio(smaller / larger)
    d = float(elliprd(0, aspect**2, 1)) / 3
    k = float(elliprf(0, aspect**2, 1))
    if quantity == "depth":
        major = float(np.sqrt(2 * larger * d * value / k))
    else:
        major = float(np.cbrt(3 * value * larger * d / (np.pi * reduced_modulus)))
    minor = aspect * major
    return HertzContact(
        semi_x=major if radius_x >= radius_y else minor,
        semi_y=minor if radius_x >= radius_y else major,
        depth=major**2 * k / (2 * larger * d),
        force=np.pi * reduced_modulus * major**3 / (3 * larger * d),
        peak_pressure=reduced_modulus * major / (2 * larger * d * aspect),
    )
