"""Dilation of sets of cells."""

from __future__ import annotations

import numpy as np
import pytest

from pellicle.arrays import Mask
from pellicle.contact.masks import dilated
from pellicle.grid import Boundary


def boxes(mask: Mask, boundary: Boundary, cells: int) -> Mask:
    """Return the union of boxes around the cells of a mask, cell by cell."""
    union = np.zeros_like(mask)
    offsets = np.arange(-cells, cells + 1)
    for cell in np.argwhere(mask):
        lines = [place + offsets for place in cell]
        if boundary == "periodic":
            lines = [line % n for line, n in zip(lines, mask.shape, strict=True)]
        else:
            lines = [
                line[(line >= 0) & (line < n)] for line, n in zip(lines, mask.shape, strict=True)
            ]
        union[np.ix_(*lines)] = True
    return union


@pytest.mark.parametrize("boundary", ["free", "periodic"])
@pytest.mark.parametrize("cells", [0, 1, 2, 4, 7, 40])
def test_boxes(boundary: Boundary, cells: int) -> None:
    """A dilated set is the union of boxes around its cells, on grids of any shape."""
    rng = np.random.default_rng(5)
    for shape in ((1, 1), (1, 9), (9, 1), (12, 17), (30, 30)):
        mask = rng.random(shape) < 0.02
        mask.flat[0] = True
        np.testing.assert_array_equal(dilated(mask, boundary, cells), boxes(mask, boundary, cells))


def test_a_line() -> None:
    """A set on one axis is dilated along it."""
    line = np.arange(8) == 0
    assert np.flatnonzero(dilated(line, cells=2)).tolist() == [0, 1, 2, 6, 7]
