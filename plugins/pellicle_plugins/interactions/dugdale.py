"""A constant traction up to a range."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from pydantic import ConfigDict

from pellicle import Grid
from pellicle.arrays import Array
from pellicle.components import Kernel
from pellicle.contact import GapLaw

from .adhesive import Adhesive
from .zone import zone_width

# Width of the zone over that of linear softening of the same energy and strength: 0.52 on a
# half-space, 0.64 on a membrane.
_NARROWER = 0.58
# Change of the gap across one cell at the outer edge, over its mean change across one cell.
_OUTER_CHANGE = 1.5
# Cells across the zone beyond which the drop is not made any steeper.
_MOST_CELLS = 50.0


class Dugdale(Adhesive):
    """Constant traction up to the range and none beyond (Dugdale 1960, Maugis 1992).

    On a grid the traction drops linearly about the range, over the change of the gap across one
    cell there: whole cells that switch off at once would be pinned by up to 0.2 πwR. Strength and
    work of adhesion are kept.
    """

    model_config = ConfigDict(title="Dugdale")

    averaged: ClassVar[bool] = True
    _SHAPE: ClassVar[float] = 1.0

    type: Literal["dugdale"] = "dugdale"
    examples = ({"work_of_adhesion": "50 mJ/m^2", "range": "2 um"},)

    def energy(self, gap: Array) -> Array:
        """Return γ(g) = −σ₀ (h₀ − g) [J/m²] up to the range h₀."""
        return -self.greatest_traction * np.maximum(self.reach - gap, 0.0)

    def traction(self, gap: Array) -> Array:
        """Return −σ₀ [Pa] up to the range."""
        return np.where(gap < self.reach, -self.greatest_traction, 0.0)

    def slope(self, gap: Array) -> Array:
        """Return 0 [Pa/m]."""
        return np.zeros_like(gap)

    def cutoff(self) -> float:
        """Return the range h₀ [m]."""
        return self.reach

    def resolved(self, kernel: Kernel, grid: Grid) -> GapLaw:
        """Return the law whose drop is spread over the gap's change across one cell."""
        cell = grid.cell_size
        width = zone_width(self.work_of_adhesion, self.greatest_traction, kernel, cell)
        share = np.clip(_OUTER_CHANGE * cell / (_NARROWER * width), 1 / _MOST_CELLS, 1.0)
        return Spread(self.greatest_traction, self.reach, self.reach * float(share))


@dataclass(frozen=True)
class Spread:
    """A constant traction that drops linearly to 0 about the range."""

    strength: float
    """Traction up to the drop [Pa]."""
    range: float
    """Gap in the middle of the drop [m]."""
    drop: float
    """Change of the gap over which the traction drops [m]."""

    def energy(self, gap: Array) -> Array:
        """Return γ(g) [J/m²]."""
        before = np.maximum(self.range - self.drop / 2 - gap, 0.0)
        share = np.clip((self.cutoff() - gap) / self.drop, 0.0, 1.0)
        return -self.strength * (before + 0.5 * self.drop * share**2)

    def traction(self, gap: Array) -> Array:
        """Return σ(g) [Pa]."""
        return -self.strength * np.clip((self.cutoff() - gap) / self.drop, 0.0, 1.0)

    def slope(self, gap: Array) -> Array:
        """Return dσ/dg [Pa/m]."""
        return np.where(np.abs(gap - self.range) < self.drop / 2, self.strength / self.drop, 0.0)

    def cutoff(self) -> float:
        """Return the end of the drop [m]."""
        return self.range + self.drop / 2
