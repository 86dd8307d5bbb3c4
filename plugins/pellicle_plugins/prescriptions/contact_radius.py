"""The radius of the contact."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from pellicle.components import Force, Prescription, Search, Setting, Variable
from pellicle.errors import ConfigError
from pellicle.units import readable

from .contact_area import RESIDUAL, area_search, unreachable


class ContactRadius(Prescription):
    """Radius of the circle with the area of the cells in contact [m]."""

    type: Literal["contact_radius"] = "contact_radius"
    examples = ({},)
    unit: ClassVar[str] = "m"
    at_least: ClassVar[float | None] = 0.0
    variables: ClassVar[tuple[Variable, ...]] = (RESIDUAL,)

    def check(self, setting: Setting, value: float) -> None:
        """Refuse a radius that the contact cannot have on this grid."""
        if problem := unreachable(setting, np.pi * value**2):
            raise ConfigError(f"{readable(value, self.unit)} is {problem}")

    def target(self, setting: Setting, value: float) -> Force | Search:
        """Return the search for the force with the area of the circle."""
        return area_search(setting, np.pi * value**2)
