"""Contact of a rigid cone and of a flat-ended cylinder with a half-space without tension.

Sneddon (1965); of the cylinder also Boussinesq (1885), and Johnson (1985), section 3.4.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.errors import ConfigError

from .arguments import positive, single


@dataclass(frozen=True)
class ConeContact:
    """Contact of a cone; the pressure is logarithmically infinite at the apex."""

    contact_radius: float
    """a [m]."""
    depth: float
    """δ [m]."""
    force: float
    """F [N]."""
    mean_pressure: float
    """F / πa² = E* cot(α) / 2 [Pa], independent of the depth."""

    def pressure(self, r: ArrayLike) -> Array:
        """Return p = (E* cot α / 2) arcosh(a / r) [Pa] at r ≥ 0 [m]; infinite at 0."""
        r = np.asarray(r, dtype=float)
        inside = (r > 0) & (r < self.contact_radius)
        ratio = self.contact_radius / np.where(inside, r, max(self.contact_radius, 1e-300))
        apex = np.inf if self.contact_radius > 0 else 0.0
        return np.where(r == 0, apex, self.mean_pressure * np.arccosh(np.maximum(ratio, 1.0)))


def cone(
    half_angle: float,
    reduced_modulus: float,
    *,
    depth: float | None = None,
    force: float | None = None,
    contact_radius: float | None = None,
) -> ConeContact:
    """Return the contact of a cone r cot α for one given quantity.

    δ = (π/2) a cot α and F = (π/2) E* a² cot α (Sneddon 1965), with δ and a in m, F in N, α in rad
    between axis and flank, and E* = E / (1 − ν²) in Pa.
    """
    positive(reduced_modulus=reduced_modulus)
    if not 0 < half_angle < np.pi / 2:
        raise ConfigError(f"must lie between 0 and π/2 rad, got {half_angle!r}", "half_angle")
    rate = np.pi / 2 / float(np.tan(half_angle))
    quantity, a = single(depth=depth, force=force, contact_radius=contact_radius)
    if quantity == "depth":
        a = a / rate
    elif quantity == "force":
        a = float(np.sqrt(a / (reduced_modulus * rate)))
    return ConeContact(
        contact_radius=a,
        depth=rate * a,
        force=reduced_modulus * rate * a**2,
        mean_pressure=reduced_modulus * rate / np.pi,
    )


@dataclass(frozen=True)
class FlatPunchContact:
    """Contact of a flat punch; the pressure is infinite at its edge."""

    contact_radius: float
    """a, the radius of the punch [m]."""
    depth: float
    """δ [m]."""
    force: float
    """F [N]."""

    def pressure(self, r: ArrayLike) -> Array:
        """Return p = F / (2πa sqrt(a² − r²)) [Pa] at r ≥ 0 [m]; infinite at a, 0 beyond."""
        ratio = np.asarray(r, dtype=float) / self.contact_radius
        inside = ratio < 1
        root = np.sqrt(np.where(inside, (1 - ratio) * (1 + ratio), 1.0))
        value = self.force / (2 * np.pi * self.contact_radius**2) / root
        edge = np.inf if self.force > 0 else 0.0
        return np.where(inside, value, np.where(ratio == 1, edge, 0.0))


def flat_punch(
    radius: float, reduced_modulus: float, *, depth: float | None = None, force: float | None = None
) -> FlatPunchContact:
    """Return the contact of a flat punch, F = 2 E* a δ, for δ [m] or F [N].

    a is its radius [m], and E* = E / (1 − ν²) [Pa].
    """
    positive(radius=radius, reduced_modulus=reduced_modulus)
    quantity, value = single(depth=depth, force=force)
    stiffness = 2 * reduced_modulus * radius
    depth = value if quantity == "depth" else value / stiffness
    return FlatPunchContact(contact_radius=radius, depth=depth, force=stiffness * depth)
