"""Adhesion of no range."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import ClassVar, Literal

import numpy as np
from pydantic import ConfigDict, Field

from pellicle import Grid
from pellicle.arrays import Array
from pellicle.components import Interaction, Kernel
from pellicle.contact import GapLaw
from pellicle.units import WorkOfAdhesion

from .finite_range import Linear, softening_strength

# Width of the zone in cells. Narrower ones pin, because a row of cells along an axis stays: of 66
# depths of a paraboloid with 256 points approach and retraction differed at 7 with 1.7 and 2.0
# cells and at 5 with 1.9 and 2.1, by up to 0.014 πwR, but at one by 0.005 with 2.25. Forces at no
# load are nearer to the theory by at most 0.003 πwR with 1.9.
_CELLS = 2.25


class JKR(Interaction):
    """Adhesion in the limit of no range (Johnson, Kendall & Roberts 1971), on any kernel.

    The grid gives the range: the traction softens linearly over two to three cells around the
    contact, and the error of force and depth falls with their size. It attracts only cells that
    are joined to a contact, and a new contact begins where the gap closes, because the range of
    the grid would attract too soon. The wall pressure depends on the grid.
    """

    model_config = ConfigDict(title="JKR")

    averaged: ClassVar[bool] = True
    least_cells: ClassVar[float] = 1.25

    also: ClassVar[tuple[str, ...]] = ("griffith", "adhesion", "johnsonkendallroberts")
    type: Literal["jkr"] = "jkr"
    examples = ({"work_of_adhesion": "50 mJ/m^2"},)
    work_of_adhesion: WorkOfAdhesion = Field(
        description="energy per area to separate a closed gap [J/m2]"
    )

    estimate_error: bool = Field(
        True,
        description="whether to solve each step again with a wider zone, for the error of its "
        "force and its limit",
    )

    def energy(self, gap: Array) -> Array:
        """Return −w [J/m²] at contact and 0 across any gap."""
        return np.where(gap > 0, 0.0, -self.work_of_adhesion)

    def traction(self, gap: Array) -> Array:
        """Return 0 [Pa]: without a grid there is no range over which a traction acts."""
        return np.zeros_like(gap)

    def cutoff(self) -> float:
        """Return 0 [m]."""
        return 0.0

    def resolved(self, kernel: Kernel, grid: Grid) -> GapLaw:
        """Return linear softening over about two to three cells on this kernel."""
        return self._softening(_CELLS, kernel, grid)

    def wider(self, factor: float) -> Callable[[Kernel, Grid], GapLaw] | None:
        """Return softening over more cells; None without `estimate_error`."""
        return partial(self._softening, factor * _CELLS) if self.estimate_error else None

    def _softening(self, cells: float, kernel: Kernel, grid: Grid) -> GapLaw:
        width = cells * grid.cell_size
        strength = softening_strength(self.work_of_adhesion, width, kernel)
        return Linear(work_of_adhesion=self.work_of_adhesion, strength=strength)
