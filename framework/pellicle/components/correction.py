"""The contract of area corrections, and their call."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar

from pellicle.arrays import Mask
from pellicle.checks import component_name, errors_attributed_to, read_only, real_number
from pellicle.errors import PluginError
from pellicle.grid import Grid

from .base import Component

# Relative rounding error of areas.
_ROUNDING = 1e-12


class AreaCorrection(Component):
    """A correction of the contact area for the discretisation."""

    family: ClassVar[str] = "correction"
    place: ClassVar[str] = "corrections[]"

    @abstractmethod
    def area(self, contact: Mask, spacing: tuple[float, float]) -> float:
        """Return the area of contact [m²].

        ``contact``, of shape (nx, ny), is true for cells in contact; ``spacing`` is the size of a
        cell along x and y [m].
        """

    def periodic_area(self, contact: Mask, spacing: tuple[float, float]) -> float:
        """Return the area of contact [m²] on a periodic domain, whose opposite edges touch.

        The default is `area`; a correction that compares neighbouring cells overrides this.
        """
        return self.area(contact, spacing)


def corrected_area(correction: AreaCorrection, contact: Mask, grid: Grid) -> float:
    """Return the corrected area of contact [m²]."""
    method = correction.periodic_area if grid.boundary == "periodic" else correction.area
    call = f"{method.__name__}(contact, spacing)"
    with errors_attributed_to(correction):
        value = method(read_only(contact), grid.spacing)
    area = real_number(correction, call, value)
    largest = grid.area if contact.any() else 0.0
    if not 0 <= area <= largest * (1 + _ROUNDING):
        raise PluginError(
            f"{component_name(correction)}: {call} returned {area:g} m²; it has to be between 0 "
            f"and {largest:g} m², {'the area of the domain' if largest else 'without contact'}"
        )
    return area
