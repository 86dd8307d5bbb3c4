"""What our own area corrections keep beyond the contract."""

import numpy as np

from pellicle import AreaCorrection


def test_correction_takes_area_off(correction: AreaCorrection) -> None:
    """Cells count as in contact where any of them is, so the area is less than they cover."""
    x, y = np.mgrid[0:40, 0:30]
    contact = np.sin(x / 3) * np.cos(y / 4) + 0.3 * np.sin(x / 5 + y) > 0
    assert correction.area(contact, (2e-6, 3e-6)) < 6e-12 * np.count_nonzero(contact)
