"""The contract of interactions: what acts across the gap, and its law on a grid."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import ClassVar

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import errors_attributed_to
from pellicle.contact.law import GapLaw, Law
from pellicle.errors import ConfigError
from pellicle.grid import Grid
from pellicle.plugins.component import Component
from pellicle.surface.operators import along_axes

from .kernel import Kernel

# Share of the cutoff over which a slope is measured.
_DIFFERENCE = 1e-6
# Relative rounding error of displacements, with some digits left for the gap.
_DIGITS = 1e-13


class Interaction(Component):
    """An energy per area γ(g) that depends on the gap g between surface and indenter.

    The traction on the surface is p = w + σ(g) with the wall pressure w ≥ 0, the gap g ≥ 0 and
    w g = 0. Methods take arrays of gaps g ≥ 0 up to the cutoff.
    """

    family: ClassVar[str] = "interaction"
    place: ClassVar[str] = "interaction"
    averaged: ClassVar[bool] = False
    """Whether the traction of the law that is resolved is averaged over each cell.

    The gap is interpolated between the cells then.
    """
    least_cells: ClassVar[float] = 3.0
    """Cells across the zone around a contact below which the cells pin its edge."""

    @abstractmethod
    def energy(self, gap: Array) -> Array:
        """Return γ(g) [J/m²]: −(work of adhesion) at g = 0, and 0 at the cutoff."""

    @abstractmethod
    def traction(self, gap: Array) -> Array:
        """Return σ(g) = −dγ/dg [Pa]; negative where surface and indenter attract each other."""

    @abstractmethod
    def cutoff(self) -> float:
        """Return the gap [m] beyond which nothing acts.

        If it is 0, the law that is resolved acts only on cells that are joined to a contact: the
        range of the cells would attract too soon.
        """

    def slope(self, gap: Array) -> Array:
        """Return dσ/dg [Pa/m]; by default from differences of `traction`."""
        half = 0.5 * _DIFFERENCE * self.cutoff()
        low, high = np.maximum(gap - half, 0.0), np.minimum(gap + half, self.cutoff())
        slopes: Array = (self.traction(high) - self.traction(low)) / (high - low)
        return slopes

    def resolved(self, kernel: Kernel, grid: Grid) -> GapLaw:
        """Return the law that the cells of ``grid`` can resolve; by default the interaction itself.

        Whole cells that switch off at once are pinned: approach and retraction end in different
        states. A law that is resolved is continuous, and its slope is bounded.
        """
        return self

    def wider(self, factor: float) -> Callable[[Kernel, Grid], GapLaw] | None:
        """Return `resolved` with a zone ``factor`` times as wide, to estimate an error.

        None, the default, if its range is its own and not that of the grid.
        """
        return None


def law_of(
    interaction: Interaction,
    kernel: Kernel,
    grid: Grid,
    resolved: Callable[[Kernel, Grid], GapLaw] | None = None,
) -> Law:
    """Return the law of an interaction, resolved on a grid.

    ``resolved`` is by default that of the interaction; `Interaction.wider` returns others.
    A range that is less than the rounding error of what the strength displaces is refused.
    """
    resolved = resolved or interaction.resolved

    def resolve(grid: Grid) -> GapLaw:
        with errors_attributed_to(interaction):
            return resolved(kernel, grid)

    with errors_attributed_to(interaction):
        needs_contact = interaction.cutoff() == 0
    law = Law(resolve(grid), resolve, interaction, needs_contact, interaction.averaged)
    with errors_attributed_to(kernel):
        compliance = along_axes(kernel.symbol, np.array([np.pi / grid.cell_size])).item()
    cutoff, strength = law.cutoff(), law.strength()
    if _DIGITS * strength * compliance > cutoff:
        raise ConfigError(
            f"has a strength of {strength:.3g} Pa, which displaces a cell by "
            f"{strength * compliance:.3g} m, and a range of {cutoff:.3g} m, which is less than the "
            "rounding error of that; give a longer range or, for adhesion of no range, jkr",
            "interaction",
        )
    return law
