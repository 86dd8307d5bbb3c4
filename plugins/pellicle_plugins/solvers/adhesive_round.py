"""A round: the hard contact closed under given tractions, and what the law then exerts."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.contact import Adhesive, Attraction, Progress

from .anderson import RoundRecord
from .front import Front
from .preconditioner import OnContact


@dataclass(frozen=True)
class Round:
    """The state after the contact is closed under given tractions across the gap."""

    problem: Adhesive
    on_contact: OnContact
    wall: Array
    """Wall pressure w [Pa]; 0 off the contact."""
    traction: Array
    """Traction across the gap, from which the contact was closed [Pa]; −(strength) in contact."""
    displacement: Array
    """Displacement [m] under the sum of both."""
    gap: Array
    depth: float
    attraction: Attraction
    """The traction of the law across `gap`."""
    settled: bool = True
    """Whether the wall pressure is ≥ 0 and no cell penetrates."""
    history: tuple[tuple[Mask, RoundRecord], ...] = ()
    """Contacts of earlier rounds, of which those on the same obey the same equations."""
    progress: Progress = field(default_factory=Progress)
    gain: float = 1.0
    """Factor on the estimated shift of the fronts."""

    @property
    def contact(self) -> Mask:
        """Cells in contact."""
        return self.on_contact.contact

    @cached_property
    def missed(self) -> Array:
        """Traction that the law exerts minus `traction` [Pa]."""
        return self.attraction.traction - self.traction

    @cached_property
    def front(self) -> Front:
        """The edge of the contact."""
        return Front(self.problem, self.contact, self.gap, self.attraction.traction)

    @property
    def record(self) -> RoundRecord:
        """The traction that was given, what it misses, and the wall pressure."""
        return RoundRecord(self.traction, self.missed, self.wall)

    @cached_property
    def on_this_contact(self) -> tuple[RoundRecord, ...]:
        """Earlier rounds on the same contact."""
        return tuple(one for contact, one in self.history if np.array_equal(contact, self.contact))

    @cached_property
    def residual(self) -> float:
        """The largest of gap, penetration, work of the wall and missed traction, each relative."""
        if self.problem.prescribed == "force" and not self.contact.any():
            return 1.0
        contact, gap = self.contact, self.gap
        closed = np.abs(gap[contact])
        error = max(float(closed.max(initial=0.0)), -float(gap.min(initial=0.0, where=~contact)))
        # The law attracts even where the wall bears it all and there is no pressure.
        exerted = float(np.abs(self.attraction.traction).sum())
        magnitude = max(float(np.abs(self.wall + self.traction).sum()), exerted)
        missed = work = 0.0
        if magnitude:
            work = float((np.abs(self.wall[contact]) * closed).sum()) / magnitude / self.scale
            missed = float(np.abs(self.missed).sum()) / magnitude
        # A round that ended before every cell was on its side is not the last.
        return max(error / self.scale, missed, work, 0.0 if self.settled else 1e-3)

    @property
    def energy(self) -> float:
        """Energy over that of closed cells all over, to the digits that show an advance."""
        bound = self.attraction.energy
        elastic = 0.5 * float(((self.wall + self.traction) * self.displacement).sum())
        load = 0.0
        if self.problem.prescribed == "force":
            load = self.depth * self.problem.value / self.problem.grid.cell_area
        return round((elastic + bound - load) / self._energy_of_closed_cells, 9)

    @property
    def energy_if_closed(self) -> float:
        """The same after the wall has closed the gap on the contact, to second order in the gap."""
        work = float((self.wall[self.contact] * self.gap[self.contact]).sum())
        return self.energy - work / self._energy_of_closed_cells

    @property
    def _energy_of_closed_cells(self) -> float:
        """Work of adhesion of all cells, over the area of one [J/m²]."""
        return self.problem.law.work_of_adhesion() * self.gap.size

    @cached_property
    def scale(self) -> float:
        """Height to which errors of the gap are compared [m]."""
        return self.problem.length_scale(self.contact, self.displacement)
