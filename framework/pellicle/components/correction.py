"""The contract of area corrections, and their call."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar

from pellicle.arrays import Mask
from pellicle.checks import component_name, errors_attributed_to, read_only, real_number
from pellicle.errors import PluginError
from pellicle.grid import Boundary, Grid
from pellicle.plugins.component import Component

# Relative rounding error of areas.
_ROUNDING = 1e-12


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


def corrected_area(correction: AreaCorrection, contact: Mask, grid: Grid) -> float:
    """Return the corrected area of contact [m²]."""
    call = "area(contact, spacing, boundary)"
    with errors_attributed_to(correction):
        value = correction.area(read_only(contact), grid.spacing, grid.boundary)
    area = real_number(correction, call, value)
    largest = grid.area if contact.any() else 0.0
    if not 0 <= area <= largest * (1 + _ROUNDING):
        raise PluginError(
            f"{component_name(correction)}: {call} returned {area:g} m²; it has to be between 0 "
            f"and {largest:g} m², {'the area of the domain' if largest else 'without contact'}"
        )
    return area
