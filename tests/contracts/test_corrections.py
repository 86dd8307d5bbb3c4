"""What every area correction keeps: an area [m²] of the cells in contact, however they lie."""

import numpy as np
import pytest
from numpy.typing import NDArray

from pellicle import AreaCorrection

SPACING = (2e-6, 3e-6)


def islands() -> NDArray[np.bool_]:
    """Return contact in half of the cells, in patches, none at the edge of the domain."""
    x, y = np.mgrid[0:40, 0:30]
    contact = np.sin(x / 3) * np.cos(y / 4) + 0.3 * np.sin(x / 5 + y) > 0
    contact[[0, 1, -2, -1]] = contact[:, [0, 1, -2, -1]] = False
    return contact


def test_no_contact_has_no_area(correction: AreaCorrection) -> None:
    """Without contact there is nothing to correct."""
    assert correction.area(np.zeros((8, 6), dtype=bool), SPACING) == 0


def test_full_contact_is_the_domain(correction: AreaCorrection) -> None:
    """Where all cells touch there is no boundary, and the area is that of the domain."""
    area = correction.area(np.ones((8, 6), dtype=bool), SPACING)
    assert area == pytest.approx(48 * SPACING[0] * SPACING[1], rel=1e-14)


def test_area_is_positive_and_near_the_count(correction: AreaCorrection) -> None:
    """A correction moves the area by less than the boundary's cells, and not below zero."""
    contact = islands()
    inner = contact[1:-1, 1:-1] & contact[2:, 1:-1] & contact[:-2, 1:-1]
    inner &= contact[1:-1, 2:] & contact[1:-1, :-2]
    cell = SPACING[0] * SPACING[1]
    area = correction.area(contact, SPACING)
    assert np.count_nonzero(inner) * cell <= area <= np.count_nonzero(contact) * cell


@pytest.mark.parametrize("factor", [1e-3, 7.0])
def test_area_scales_with_the_cells(correction: AreaCorrection, factor: float) -> None:
    """Cells larger by a factor make an area larger by its square."""
    larger = correction.area(islands(), (factor * SPACING[0], factor * SPACING[1]))
    assert larger == pytest.approx(factor**2 * correction.area(islands(), SPACING), rel=1e-12)


def test_area_does_not_depend_on_the_view(correction: AreaCorrection) -> None:
    """Mirrored, moved, or with x and y exchanged, the contact has the same area."""
    contact = islands()
    area = correction.area(contact, SPACING)
    for seen in (contact[::-1], contact[:, ::-1], np.roll(contact, (1, -1), axis=(0, 1))):
        assert correction.area(seen, SPACING) == pytest.approx(area, rel=1e-12)
    assert correction.area(contact.T, SPACING[::-1]) == pytest.approx(area, rel=1e-12)
