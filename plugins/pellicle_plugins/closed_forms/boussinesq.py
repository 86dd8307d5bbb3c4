"""Contact of a rigid flat-ended cylinder with a half-space without tension.

Boussinesq (1885); Sneddon (1965); Johnson (1985), section 3.4.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array

from .arguments import positive, single


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
