"""The grid: cells, coordinates, wavenumbers, and fields between it and a coarser one."""

import numpy as np
import pytest
import scipy.fft

import pellicle as pl
from pellicle import Depth, Force, Grid, Problem
from pellicle.surface import operator_of
from pellicle.surface.grid_transfer import highest, prolong, restrict
from pellicle_plugins.kernels.half_spaces import HalfSpace


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


# Fine shape, coarse shape: halves, odd, primes, one cell, and numbers that share no factor.
PAIRS = [
    ((8, 6), (4, 3)),
    ((9, 7), (5, 4)),
    ((97, 61), (49, 31)),
    ((12, 12), (5, 7)),
    ((1, 5), (1, 3)),
    ((1, 1), (1, 1)),
]


def field(shape: tuple[int, int]) -> np.ndarray:
    """Return random negative heights."""
    return -np.random.default_rng(2).uniform(0.5, 2, size=shape)


@pytest.mark.parametrize(("fine", "coarse"), PAIRS)
def test_restrict_is_the_mean_of_the_cells_within(
    fine: tuple[int, int], coarse: tuple[int, int]
) -> None:
    """Each coarse cell holds the mean of those fine cells whose centres lie in it."""
    heights = field(fine)
    centres = [(np.arange(n) + 0.5) / n for n in fine]
    expected = np.empty(coarse)
    for i in range(coarse[0]):
        for j in range(coarse[1]):
            rows, columns = (
                np.floor(c * n + 1e-12).astype(int) == k
                for c, n, k in zip(centres, coarse, (i, j), strict=True)
            )
            expected[i, j] = heights[np.ix_(rows, columns)].mean()
    np.testing.assert_allclose(restrict(heights, coarse), expected, rtol=1e-14)


@pytest.mark.parametrize(("fine", "coarse"), PAIRS)
def test_prolong_then_restrict_changes_nothing(
    fine: tuple[int, int], coarse: tuple[int, int]
) -> None:
    """A pressure put on a finer grid is constant over what `restrict` takes the mean of."""
    pressure = field(coarse)
    finer = prolong(pressure, fine)
    assert finer.shape == fine
    np.testing.assert_allclose(restrict(finer, coarse), pressure, rtol=1e-14)


@pytest.mark.parametrize(("fine", "coarse"), PAIRS)
def test_highest_is_that_of_the_cells_within(
    fine: tuple[int, int], coarse: tuple[int, int]
) -> None:
    """Each fine cell is no higher than the coarse one in which it lies; one of them is as high."""
    heights = field(fine)
    peaks = highest(heights, coarse)
    above = prolong(peaks, fine)
    assert (heights <= above).all()
    assert (heights == above).sum() == peaks.size


def test_half_without_indenter_is_without() -> None:
    """−inf spreads to a coarse cell if half of it has none, and counts for nothing otherwise."""
    nothing = -np.inf
    heights = np.array(
        [
            [-1.0, -2.0, nothing, -3.0, nothing, nothing],
            [-3.0, -6.0, -4.0, -5.0, -7.0, nothing],
            [-1.0, nothing, nothing, nothing, -1.0, -1.0],
            [nothing, -9.0, nothing, nothing, -1.0, -1.0],
        ]
    )
    expected = [[-3.0, -4.0, nothing], [nothing, nothing, -1.0]]
    np.testing.assert_array_equal(restrict(heights, (2, 3)), expected)


@pytest.mark.parametrize(
    ("points", "expected"),
    [((8, 6), (4, 3)), ((9, 7), (5, 4)), ((97, 1), (49, 1)), ((1, 1), (1, 1)), ((3, 2), (2, 1))],
)
def test_coarsened_grid(points: tuple[int, int], expected: tuple[int, int]) -> None:
    """Half as many cells, rounded up, on the same domain with the same boundary."""
    grid = Grid(points=points, size=(2.0, 3.0), boundary="periodic")
    coarse = grid.coarsened()
    assert coarse.points == expected
    assert coarse.size == grid.size
    assert coarse.boundary == grid.boundary
    assert Grid(**coarse.model_dump()) == coarse


@pytest.mark.parametrize("control", [Depth(3.0), Force(3.0)])
def test_coarsened_problem(control: Depth | Force) -> None:
    """The same load on the coarse grid; an operator of its own leaves the fine one's count."""
    grid = Grid(points=(9, 6), size=(2.0, 3.0))
    kernel = HalfSpace(reduced_modulus=2.0)
    fine = Problem(grid, operator_of(kernel, grid), field(grid.shape), control)
    coarse = fine.coarsened()
    assert coarse.grid == grid.coarsened() == coarse.operator.grid
    assert coarse.control == control
    np.testing.assert_array_equal(coarse.profile, restrict(fine.profile, (5, 3)))
    pressure = np.ones(coarse.grid.shape)
    np.testing.assert_array_equal(
        coarse.operator(pressure), operator_of(kernel, coarse.grid)(pressure)
    )
    assert (fine.operator.applications, coarse.operator.applications) == (0, 1)
