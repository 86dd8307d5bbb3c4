"""The grid: cells, coordinates and wavenumbers."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.fft

import pellicle as pl


@pytest.mark.parametrize("points", [[4, 6], [5, 7], [1, 3]])
def test_coordinates_are_centred_cells(points: list[int]) -> None:
    """Cell centres are a spacing apart, half a cell from the edge, and centred on the origin."""
    grid = pl.Grid(points=points, size=[2.0, 3.0])
    x, y = grid.coordinates()
    assert x.shape == (points[0], 1)
    assert y.shape == (1, points[1])
    for axis, size, spacing in zip((x.ravel(), y.ravel()), grid.size, grid.spacing, strict=True):
        assert axis == pytest.approx(-axis[::-1], abs=1e-15)
        assert np.diff(axis) == pytest.approx(spacing)
        assert axis[0] - spacing / 2 == pytest.approx(-size / 2)


@pytest.mark.parametrize("points", [[8, 6], [7, 9], [8, 5], [1, 4]])
def test_wavenumbers_are_those_of_rfft2(points: list[int]) -> None:
    """A wave of wavenumber (qx, qy) is the one coefficient of rfft2 at its place."""
    grid = pl.Grid(points=points, size=[2.0, 3.0], boundary="periodic")
    x, y = grid.coordinates()
    qx, qy = grid.wavenumbers()
    transform = scipy.fft.rfft2(np.zeros(grid.shape))
    assert np.broadcast_shapes(qx.shape, qy.shape) == transform.shape
    for i, j in [(0, 1), (points[0] // 2 - (points[0] > 1), 0), (points[0] - 1, 1)]:
        wave = np.cos(qx[i, 0] * x + qy[0, j] * y)
        strength = np.abs(scipy.fft.rfft2(wave))
        assert strength[i, j] == strength.max()
        assert strength[i, j] > 0.49 * wave.size


def test_one_number_stands_for_both_directions() -> None:
    """A square grid may be given by one number of points and one size."""
    assert pl.Grid(points=8, size="1 mm") == pl.Grid(points=[8, 8], size=["1 mm", 1e-3])


def test_areas() -> None:
    """Cell area and domain area follow from size and points."""
    grid = pl.Grid(points=[4, 8], size=[2.0, 3.0])
    assert grid.spacing == (0.5, 0.375)
    assert grid.cell_area == pytest.approx(0.1875)
    assert grid.area == pytest.approx(6.0)
    assert grid.shape == (4, 8)


@pytest.mark.parametrize("points", [-1, 0, 1.5, "8", True, [8], [8, 8, 8], None, 10**400])
def test_bad_points(points: object) -> None:
    """Points are one or two whole numbers above 0."""
    with pytest.raises(pl.ConfigError, match=r"^points"):
        pl.Grid(points=points, size=1)
