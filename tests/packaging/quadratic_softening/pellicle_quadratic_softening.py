"""A stranger's interaction."""

from typing import Annotated, Literal

from pydantic import Field

import pellicle as pl
from pellicle.units import Length, WorkOfAdhesion


class QuadraticSoftening(pl.Interaction):
    """Traction that falls as the square of what is left of the range."""

    type: Literal["quadratic_softening"] = "quadratic_softening"
    work_of_adhesion: Annotated[WorkOfAdhesion, Field(description="work of adhesion w [J/m2]")]
    range: Annotated[Length, Field(description="gap at which the traction ends [m]")]

    def energy(self, gap):
        """Return −w (1 − g/g₀)³ [J/m²]."""
        return -self.work_of_adhesion * (1 - gap / self.range).clip(0) ** 3

    def traction(self, gap):
        """Return −(3w/g₀) (1 − g/g₀)² [Pa]."""
        return -3 * self.work_of_adhesion / self.range * (1 - gap / self.range).clip(0) ** 2

    def cutoff(self):
        """Return g₀ [m]."""
        return self.range
