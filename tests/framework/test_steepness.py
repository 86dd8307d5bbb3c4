"""The slopes of indenters in contact, whatever their direction."""

import numpy as np
import pytest

import pellicle as pl
from pellicle import Grid
from pellicle.analysis import steepest
from pellicle.arrays import Array

GRID = Grid(points=(40, 60), size=(2.0, 2.4))
X, Y = np.broadcast_arrays(*(axis - axis.mean() for axis in GRID.coordinates()))


def _roof(angle: float) -> Array:
    """Return heights [m] that fall to both sides of a ridge with a slope of 0.35."""
    heights: Array = -0.35 * np.abs(np.cos(angle) * X + np.sin(angle) * Y)
    return heights


@pytest.mark.parametrize("angle", np.deg2rad([0.0, 20.0, 45.0, 70.0, 90.0]))
def test_slope_of_a_roof_at_any_angle(angle: float) -> None:
    """A plane slopes by the same in any direction, on cells that are not square, too."""
    assert steepest(_roof(angle), X < 9, GRID) == pytest.approx(0.35, rel=1e-9)


def test_slope_of_a_paraboloid_is_that_at_its_rim() -> None:
    """Less than half a cell inside of r/R."""
    contact = X**2 + Y**2 < 0.7**2
    assert 0.66 / 3 < steepest(-(X**2 + Y**2) / 6, contact, GRID) < 0.7 / 3


def test_contacts_of_few_cells_have_the_slopes_between_them() -> None:
    """A row has those along it, cells apart from each other none, nor has the ground beside."""
    heights = -np.abs(X)
    heights[~np.isclose(np.abs(Y), 0.02)] = -np.inf
    assert steepest(heights, np.isfinite(heights), GRID) == pytest.approx(1.0)
    assert steepest(heights, np.isclose(X, 0.025) & np.isfinite(heights), GRID) == 0.0
    assert steepest(heights, np.zeros(GRID.shape, dtype=bool), GRID) == 0.0


@pytest.mark.parametrize("degrees", [0.0, 45.0])
def test_a_turned_pyramid_is_as_steep(degrees: float) -> None:
    """A pyramid whose sides slope by 0.35 is beyond the theory at any angle."""
    x = (np.arange(32) + 0.5) / 16 - 1
    angle = np.deg2rad(degrees)
    one = np.cos(angle) * x[:, None] + np.sin(angle) * x
    other = np.cos(angle) * x - np.sin(angle) * x[:, None]
    pyramid = -0.35 * np.maximum(np.abs(one), np.abs(other))
    with pytest.warns(pl.ConvergenceWarning, match=r"slopes in contact reach 0\.35"):
        result = pl.run(
            {
                "grid": {"points": 32, "size": 2.0, "boundary": "free"},
                "kernel": {"type": "half_space", "reduced_modulus": 1.0},
                "indenter": {"type": "heights", "values": pyramid.tolist(), "unit": 1.0},
                "interaction": {"type": "jkr", "work_of_adhesion": 1e-3},
                "loading": {"depth": 0.15},
            },
            progress=False,
        )
    assert [step for step, _ in result.steep()] == [1]


def test_a_step_between_any_two_rows_counts() -> None:
    """The slope is the largest of blocks of rows, each of which holds the first row of the next."""
    grid = Grid(points=(300, 400), size=(3.0, 4.0))
    for row in range(1, 300):
        heights = np.zeros(grid.shape)
        heights[row:, 7] = -0.004
        contact = np.zeros(grid.shape, dtype=bool)
        contact[row - 1 : row + 1, 7] = True
        assert steepest(heights, contact, grid) == pytest.approx(0.4)


def test_slope_at_the_rim_of_a_contact_that_sticks() -> None:
    """Under a tension τ₀ the surface meets the indenter at √(2w/τ₀), whatever the indenter is."""
    run = {
        "grid": {"points": 32, "size": 4.0},
        "kernel": {"type": "tensed_membrane", "reduced_modulus": 1.0, "tension": 1.0},
        "indenter": {"type": "paraboloid", "radius": 2.0},
        "interaction": {"type": "jkr", "work_of_adhesion": 0.5 * 0.35**2},
        "loading": {"depth": [0.03, -0.05]},
    }
    with pytest.warns(pl.ConvergenceWarning, match=r"slopes in contact reach 0\.35"):
        pl.run(run, progress=False)
