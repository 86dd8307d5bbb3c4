"""Contact of a rigid cone with a half-space without tension; Sneddon (1965)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.errors import ConfigError
from pellicle_axisymmetric import positive, single


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
