"""Tractions of a given work of adhesion and range or strength, and the zone in which they pull."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import ConfigDict, Field, model_validator

from pellicle import Grid
from pellicle.arrays import Array
from pellicle.components import Interaction, Kernel
from pellicle.contact import GapLaw
from pellicle.surface import along_axes
from pellicle.units import Length, Strength, WorkOfAdhesion

# q times the width of the zone of `softening_strength`. The gap in the zone is a wave for which
# 1/G(q) = dσ/dg. A quarter of it, π/2, fits on a membrane; 1.27 was measured on a half-space.
_PHASE = 1.4


def softening_strength(work_of_adhesion: float, width: float, kernel: Kernel) -> float:
    """Return the strength [Pa] of linear softening whose zone is about ``width`` [m] wide.

    The traction −σ₀(1 − g/g_max), with g_max = 2w/σ₀, has the slope σ₀²/(2w), which the stiffness
    1/G(q) of the zone's own wave balances.
    """
    compliance = along_axes(kernel.symbol, np.array([_PHASE / width])).item()
    return float(np.sqrt(2 * work_of_adhesion / compliance))


def zone_width(work_of_adhesion: float, strength: float, kernel: Kernel, cell: float) -> float:
    """Return the approximate width [m] of the zone of a law with ``strength`` [Pa].

    It is the width for which `softening_strength` gives this strength, between 10⁻³ and 10⁶ times
    the width of a ``cell`` [m].
    """
    from scipy.optimize import brentq

    def excess(log_width: float) -> float:
        return float(
            np.log(softening_strength(work_of_adhesion, np.exp(log_width), kernel) / strength)
        )

    low, high = np.log(1e-3 * cell), np.log(1e6 * cell)
    if excess(low) < 0:
        return float(np.exp(low))
    if excess(high) > 0:
        return float(np.exp(high))
    return float(np.exp(brentq(excess, low, high, xtol=1e-3)))


class Adhesive(Interaction):
    """An interaction given by its work of adhesion and either its range or its strength."""

    model_config = ConfigDict(
        json_schema_extra={"oneOf": [{"required": ["range"]}, {"required": ["strength"]}]}
    )
    # Work of adhesion over strength times range.
    _SHAPE: ClassVar[float]

    work_of_adhesion: WorkOfAdhesion = Field(
        description="energy per area to separate a closed gap [J/m2]"
    )
    range: Length | None = Field(
        None, description="gap at which the traction ends [m]; or strength"
    )
    strength: Strength | None = Field(
        None, description="traction that separates a closed gap [Pa]; or range"
    )

    @property
    def reach(self) -> float:
        """The range [m], as given or from the strength."""
        if self.range is not None:
            return self.range
        assert self.strength is not None
        return self.work_of_adhesion / (self._SHAPE * self.strength)

    @property
    def greatest_traction(self) -> float:
        """The strength [Pa], as given or from the range."""
        return self.work_of_adhesion / (self._SHAPE * self.reach)

    @model_validator(mode="after")
    def _range_or_strength(self) -> Self:
        if (self.range is None) == (self.strength is None):
            both = "are both given" if self.range is not None else "are both missing"
            raise ValueError(f"range and strength {both}; give one of them")
        return self


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

    also: ClassVar[tuple[str, ...]] = ("dmt", "maugis", "maugisdugdale", "md", "squarewell")
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
