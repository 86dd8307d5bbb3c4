"""Calls of a correction of the area of contact."""

from __future__ import annotations

from pellicle.arrays import Mask
from pellicle.checks import component_name, errors_attributed_to, read_only, real_number
from pellicle.components.correction import AreaCorrection
from pellicle.errors import PluginError
from pellicle.grid import Grid

# Relative rounding error of areas.
_ROUNDING = 1e-12


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
