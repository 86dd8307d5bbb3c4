"""The area of the cells in contact, and the radius of a circle of that area."""

from __future__ import annotations

import math
from typing import ClassVar, Literal

import numpy as np

from pellicle.components import Depth, Force, Prescription, Search, Setting, Variable
from pellicle.contact import Equilibrium
from pellicle.errors import ConfigError
from pellicle.units import readable

_RESIDUAL = Variable(
    "residual_area", "1", "relative error of the prescribed contact area or radius", "residual"
)


class ContactArea(Prescription):
    """Area of the cells in contact [m²], attained to the nearest whole number of cells."""

    type: Literal["contact_area"] = "contact_area"
    examples = ({},)
    unit: ClassVar[str] = "m2"
    at_least: ClassVar[float | None] = 0.0
    variables: ClassVar[tuple[Variable, ...]] = (_RESIDUAL,)

    def check(self, setting: Setting, value: float) -> None:
        """Refuse an area that the indenter cannot have on this grid."""
        if problem := _unreachable(setting, value):
            raise ConfigError(f"{readable(value, self.unit)} is {problem}")

    def target(self, setting: Setting, value: float) -> Force | Search:
        """Return a search for the force with this contact area; no force for an area of 0."""
        return _area_search(setting, value)


def _unreachable(setting: Setting, area: float) -> str:
    """Return the reason why a contact area [m²] is impossible on this grid; empty if possible."""
    if setting.sticks and not area > 0:
        return "lost at no certain depth where the contact sticks; prescribe depth"
    cell, profile = setting.grid.cell_area, setting.profile
    covered = int(np.count_nonzero(np.isfinite(profile)))
    first = int(np.count_nonzero(profile == profile.max()))
    if area > (covered + 0.5) * cell:
        owner = "the domain" if covered == profile.size else "the indenter"
        return f"more than {owner} has, {readable(covered * cell, 'm2')}; give less"
    if area > 0 and first == covered:
        return (
            f"not within reach: the indenter is flat, and all its "
            f"{readable(covered * cell, 'm2')} touch at once, under any load; prescribe depth "
            "or force"
        )
    if 0 < area < (first - 0.5) * cell:
        return (
            f"less than the {first} cells of {readable(cell, 'm2')} that touch first, all at "
            "once; give more, or use more points"
        )
    return ""


def _area_search(setting: Setting, area: float) -> Force | Search:
    """Return the search for a contact area [m²], starting near the force of the last step."""
    if not area > 0:
        return Force(0.0)
    cell, state = setting.grid.cell_area, setting.state
    guess: float | None
    if setting.sticks and state is not None:
        guess = state.depth
    elif state is not None and state.contact.any():
        before = float(np.count_nonzero(state.contact)) * cell
        guess = float(state.pressure.sum()) * cell * math.pow(area / before, 1.5)
    else:
        heights = np.sort(setting.profile[np.isfinite(setting.profile)])[::-1]
        lowest = heights[min(math.ceil(area / cell + 0.5), heights.size - 1)]
        # Slightly deeper, because exactly at the height of a cell round-off decides its contact.
        depth = -1.01 * float(lowest)
        guess = depth if setting.sticks else setting.force_at(depth)

    def measure(step: Equilibrium) -> float:
        return float(np.count_nonzero(step.counted_contact)) * cell

    # A jump is located to 1e-4 of the control; half a cell means the nearest whole number of cells.
    # Along the force a contact that sticks would jump.
    return Search(
        goal=area,
        measure=measure,
        control=Depth if setting.sticks else Force,
        resolution=cell / 2,
        width=1e-4,
        guess=guess,
        in_cells=True,
        quantity="contact area",
        unit="m2",
    )


class ContactRadius(Prescription):
    """Radius of the circle with the area of the cells in contact [m]."""

    type: Literal["contact_radius"] = "contact_radius"
    examples = ({},)
    unit: ClassVar[str] = "m"
    at_least: ClassVar[float | None] = 0.0
    variables: ClassVar[tuple[Variable, ...]] = (_RESIDUAL,)

    def check(self, setting: Setting, value: float) -> None:
        """Refuse a radius that the contact cannot have on this grid."""
        if problem := _unreachable(setting, np.pi * value**2):
            raise ConfigError(f"{readable(value, self.unit)} is {problem}")

    def target(self, setting: Setting, value: float) -> Force | Search:
        """Return the search for the force with the area of the circle."""
        return _area_search(setting, np.pi * value**2)
