"""Linear softening."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from pellicle.arrays import Array

from .adhesive import Adhesive


class Linear(Adhesive):
    """Traction that falls linearly from the strength at contact to 0 at the range.

    It is continuous where the zone begins and where it ends, so cells do not pin it if the zone is
    1.5 of them wide or more.
    """

    least_cells: ClassVar[float] = 1.25
    _SHAPE: ClassVar[float] = 0.5

    type: Literal["linear"] = "linear"
    examples = ({"work_of_adhesion": "50 mJ/m^2", "strength": "20 kPa"},)

    def energy(self, gap: Array) -> Array:
        """Return γ(g) = −w (1 − g/g₀)² [J/m²] up to the range g₀."""
        return -self.work_of_adhesion * self._closed(gap) ** 2

    def traction(self, gap: Array) -> Array:
        """Return σ(g) = −σ₀ (1 − g/g₀) [Pa] up to the range g₀."""
        return -self.greatest_traction * self._closed(gap)

    def slope(self, gap: Array) -> Array:
        """Return dσ/dg = σ₀/g₀ [Pa/m] up to the range g₀."""
        return np.where(gap < self.reach, self.greatest_traction / self.reach, 0.0)

    def cutoff(self) -> float:
        """Return the range g₀ [m]."""
        return self.reach

    def _closed(self, gap: Array) -> Array:
        return np.maximum(1 - gap / self.reach, 0.0)
