"""The traction that acts across the gap between surface and indenter."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import (
    component_name,
    errors_attributed_to,
    read_only,
    real_array,
    real_number,
)
from pellicle.errors import PluginError
from pellicle.grid import Grid
from pellicle.units import LARGEST


class GapLaw(Protocol):
    """An energy per area that depends on the gap."""

    def energy(self, gap: Array) -> Array:
        """Return γ(g) [J/m²] for gaps g ≥ 0 [m]; −(work of adhesion) at 0, and 0 far away."""
        ...

    def traction(self, gap: Array) -> Array:
        """Return σ(g) = −dγ/dg [Pa]; negative where surface and indenter attract each other."""
        ...

    def slope(self, gap: Array) -> Array:
        """Return dσ/dg [Pa/m]."""
        ...

    def cutoff(self) -> float:
        """Return the gap [m] beyond which nothing acts."""
        ...


@dataclass(frozen=True)
class Law:
    """A gap law on a grid, in the units of length and pressure of a problem.

    Gaps below 0 count as 0. A value that is not a finite number raises a `PluginError` that names
    the interaction.
    """

    law: GapLaw
    """The law as it is resolved on the grid."""
    resolve: Callable[[Grid], GapLaw]
    """Return the law as it is resolved on another grid."""
    source: object
    """The interaction that it is the law of."""
    needs_contact: bool = False
    """Whether it acts only on cells that are joined to a contact."""
    averaged: bool = False
    """Whether its traction is averaged over each cell."""
    length: float = 1.0
    """Unit of length [m]."""
    pressure: float = 1.0
    """Unit of pressure [Pa]."""

    @property
    def name(self) -> str:
        """The interaction's name in messages."""
        return component_name(self.source)

    def energy(self, gap: Array) -> Array:
        """Return γ(g) of an array of gaps."""
        return self._values("energy", gap) / (self.length * self.pressure)

    def traction(self, gap: Array) -> Array:
        """Return σ(g) of an array of gaps, 0 beyond the cutoff."""
        values = self._values("traction", gap) / self.pressure
        return np.where(gap < self.cutoff(), values, 0.0)

    def slope(self, gap: Array) -> Array:
        """Return dσ/dg of an array of gaps, 0 beyond the cutoff."""
        values = self._values("slope", gap) * (self.length / self.pressure)
        return np.where(gap < self.cutoff(), values, 0.0)

    def cutoff(self) -> float:
        """Return the gap beyond which nothing acts."""
        with errors_attributed_to(self.source):
            value = self.law.cutoff()
        cutoff = real_number(self.source, "cutoff()", value)
        if not 0 < cutoff < LARGEST:
            raise PluginError(
                f"{self.name}: cutoff() is {cutoff:g} m; it has to be > 0 and < {LARGEST:g} m"
            )
        return cutoff / self.length

    def work_of_adhesion(self) -> float:
        """Return −γ(0)."""
        return -float(self.energy(np.zeros(1))[0])

    def strength(self) -> float:
        """Return the traction that separates a closed gap, −σ(0)."""
        return -float(self.traction(np.zeros(1))[0])

    def scaled(self, length: float, pressure: float) -> Law:
        """Return the law in units of ``length`` and ``pressure`` of the present units."""
        return replace(self, length=self.length * length, pressure=self.pressure * pressure)

    def on(self, grid: Grid) -> Law:
        """Return the law as it is resolved on another grid."""
        return replace(self, law=self.resolve(grid))

    def _values(self, name: Literal["energy", "traction", "slope"], gap: Array) -> Array:
        # Far from the indenter the gap is infinite, for which a formula may have no value.
        gap = np.clip(gap, 0.0, self.cutoff()) * self.length
        with errors_attributed_to(self.source):
            values = getattr(self.law, name)(read_only(gap))
        values = real_array(self.source, f"{name}(gap)", values, gap.shape)
        if not np.isfinite(values).all():
            raise PluginError(
                f"{self.name}: {name}(gap) has values that are NaN or infinite; it has to be "
                "finite for every gap up to the cutoff"
            )
        return values
