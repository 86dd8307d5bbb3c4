"""The contract of area corrections."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar

from pellicle.arrays import Mask
from pellicle.grid import Boundary
from pellicle.plugins.component import Component


class AreaCorrection(Component):
    """A correction of the contact area for the discretisation."""

    family: ClassVar[str] = "correction"
    place: ClassVar[str] = "corrections[]"

    @abstractmethod
    def area(self, contact: Mask, spacing: tuple[float, float], boundary: Boundary) -> float:
        """Return the area of contact [m²].

        ``contact``, of shape (nx, ny), is true for cells in contact; ``spacing`` is the size of a
        cell along x and y [m]. With the ``boundary`` "periodic" opposite edges touch.
        """
