"""Contract rules of area corrections: an area [m²] that does not depend on the view."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Mask
from pellicle.components import AreaCorrection
from pellicle.components.calls import corrected_area
from pellicle.grid import Boundary, Grid

from .component import check, require, require_close, rules_of
from .small_runs import solve_small_run

_SPACING = (2e-6, 3e-6)
_CELL = _SPACING[0] * _SPACING[1]


def check_correction(correction: AreaCorrection) -> None:
    """Check that an area correction keeps its contract: the rules below, and those of all."""
    check(correction, AreaCorrection, rules_of(__name__))


def _islands() -> Mask:
    """Return patches of contact in half of the cells, none at the edge of the domain."""
    x, y = np.mgrid[0:40, 0:30]
    contact: Mask = np.sin(x / 3) * np.cos(y / 4) + 0.3 * np.sin(x / 5 + y) > 0
    contact[[0, 1, -2, -1]] = contact[:, [0, 1, -2, -1]] = False
    return contact


def _area(
    correction: AreaCorrection,
    contact: Mask,
    spacing: tuple[float, float] = _SPACING,
    boundary: Boundary = "free",
) -> float:
    size = (contact.shape[0] * spacing[0], contact.shape[1] * spacing[1])
    return corrected_area(
        correction, contact, Grid(points=contact.shape, size=size, boundary=boundary)
    )


def _require_area(area: float, expected: float, which: str) -> None:
    require_close(area, expected, f"the area [m²] {which}", relative=1e-12)


def no_contact_has_no_area(correction: AreaCorrection) -> None:
    """The area is a number, 0 without contact; the argument ``contact`` stays as it is."""
    _area(correction, np.zeros((8, 6), dtype=bool))


def full_contact_is_the_domain(correction: AreaCorrection) -> None:
    """In full contact the area is that of the domain."""
    area = _area(correction, np.ones((8, 6), dtype=bool))
    _require_area(area, 48 * _CELL, "of full contact")


def area_is_near_the_count(correction: AreaCorrection) -> None:
    """A correction changes the area by less than the cells on either side of the boundary."""
    # Imported here because the workers of `check_executor` import this package too.
    from scipy.ndimage import binary_dilation, binary_erosion

    contact = _islands()
    least = _CELL * np.count_nonzero(binary_erosion(contact))
    most = _CELL * np.count_nonzero(binary_dilation(contact))
    area = _area(correction, contact)
    require(least <= area <= most, f"{area:g} m², not between {least:g} and {most:g}")


def area_scales_with_the_cells(correction: AreaCorrection) -> None:
    """The area grows with the square of the size of the cells."""
    area = _area(correction, _islands())
    for factor in (1e-3, 7.0):
        larger = _area(correction, _islands(), (factor * _SPACING[0], factor * _SPACING[1]))
        _require_area(larger, factor**2 * area, f"of cells {factor:g} × as wide")


def area_does_not_depend_on_the_view(correction: AreaCorrection) -> None:
    """A contact that is mirrored, shifted or has x and y exchanged has the same area."""
    contact = _islands()
    area = _area(correction, contact)
    for view, cells, spacing in (
        ("mirrored across x", contact[::-1], _SPACING),
        ("mirrored across y", contact[:, ::-1], _SPACING),
        ("shifted", np.roll(contact, (1, -1), axis=(0, 1)), _SPACING),
        ("with x and y exchanged", contact.T, _SPACING[::-1]),
    ):
        _require_area(_area(correction, cells, spacing), area, view)


def periodic_area_has_no_seam(correction: AreaCorrection) -> None:
    """On a periodic domain the area does not depend on the position of the edge."""
    contact = _islands()
    area = _area(correction, contact, boundary="periodic")
    _require_area(area, _area(correction, contact), "inside the domain")
    for shift in ((7, 0), (0, 11), (20, 15)):
        shifted = np.roll(contact, shift, axis=(0, 1))
        _require_area(
            _area(correction, shifted, boundary="periodic"),
            area,
            f"shifted by {shift} cells across the edge",
        )


def goes_into_the_result(correction: AreaCorrection) -> None:
    """The result of a run has the area as contact_area_<type>."""
    dataset = solve_small_run(loading={"depth": "50 um"}, corrections=[correction])
    area = dataset[f"contact_area_{correction.type_name}"].item()
    require(area > 0, f"{area:g} m² for {dataset['contact_area'].item():g} m² of cells")
