"""An attraction that decays exponentially with the gap."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import Interaction
from pellicle.units import Length, WorkOfAdhesion

# Energy at the cutoff over that at contact.
_CUTOFF = 1e-6


class Exponential(Interaction):
    """Energy −w e^(−g/range), smooth for every gap; the strength is w over the range."""

    also: ClassVar[tuple[str, ...]] = (
        *("lj", "lj93", "lj126", "lennardjones", "vdw", "vanderwaals", "morse", "rst", "smooth"),
    )
    type: Literal["exponential"] = "exponential"
    examples = ({"work_of_adhesion": "50 mJ/m^2", "range": "1 um"},)
    work_of_adhesion: WorkOfAdhesion = Field(
        description="energy per area to separate a closed gap [J/m2]"
    )
    range: Length = Field(description="decay length of the energy [m]")

    def energy(self, gap: Array) -> Array:
        """Return γ(g) = −w e^(−g/range) [J/m²]."""
        return -self.work_of_adhesion * np.exp(-gap / self.range)

    def traction(self, gap: Array) -> Array:
        """Return σ(g) = −(w/range) e^(−g/range) [Pa]."""
        return self.energy(gap) / self.range

    def slope(self, gap: Array) -> Array:
        """Return dσ/dg = (w/range²) e^(−g/range) [Pa/m]."""
        return -self.energy(gap) / self.range**2

    def cutoff(self) -> float:
        """Return the gap [m] at which the energy is 10⁻⁶ w."""
        return -float(np.log(_CUTOFF)) * self.range
