"""The contract of area corrections."""

from __future__ import annotations

from abc import abstractmethod
from typing import (
    ClassVar,
)

from pellicle.arrays import Mask

from .base import Component


class AreaCorrection(Component):
    """Corrects the area of contact for the discretisation."""

    family: ClassVar[str] = "correction"

    @abstractmethod
    def area(self, contact: Mask, spacing: tuple[float, float]) -> float:
        """Return the area of contact [m²].

        ``contact`` of shape (nx, ny) tells the cells in contact; ``spacing`` [m] their edges.
        """

    def periodic_area(self, contact: Mask, spacing: tuple[float, float]) -> float:
        """Return the area of contact [m²] on a periodic domain, whose opposite edges touch.

        That of `area` here; a correction that looks at neighbouring cells overrides this.
        """
        return self.area(contact, spacing)
