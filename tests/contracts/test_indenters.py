"""What every indenter keeps: a profile on the grid's points, with its lowest point at 0."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import pellicle as pl
from pellicle import Grid, Indenter

Examples = dict[str, dict[str, dict[str, Any]]]
Array = NDArray[np.float64]
GRID = Grid(points=[13, 11], size=["1.3 mm", "1.1 mm"])
OF_REVOLUTION = {"paraboloid", "sphere", "cone", "flat_punch"}


def points() -> tuple[Array, Array]:
    """Return coordinates that cannot be written to; one point lies at the origin."""
    x, y = GRID.coordinates()
    x.setflags(write=False)
    y.setflags(write=False)
    return x, y


def test_profile_has_the_shape_of_the_grid(indenter: Indenter) -> None:
    """Coordinates of shapes (nx, 1) and (1, ny) make float64 heights of shape (nx, ny)."""
    profile = indenter.profile(*points())
    assert profile.shape == GRID.shape
    assert profile.dtype == np.float64


def test_profile_is_nowhere_above_the_lowest_point(indenter: Indenter) -> None:
    """Heights are ≤ 0, finite or −inf, and somewhere there is an indenter."""
    profile = indenter.profile(*points())
    assert (profile <= 0).all()
    assert np.isfinite(profile).any()


def test_lowest_point_is_at_zero(indenter: Indenter) -> None:
    """The highest value is 0, or differs from it by what a cell can hide."""
    profile = indenter.profile(*points())
    if indenter.footprint == "unbounded":
        assert profile.max() == 0
    else:
        assert -profile.max() <= 0.1 * np.ptp(profile)


def test_profile_is_a_function_of_its_arguments(indenter: Indenter) -> None:
    """Asking twice gives the same heights, in arrays of their own."""
    first = indenter.profile(*points())
    again = first.copy()
    if first.flags.writeable:
        first[...] = np.nan
    np.testing.assert_array_equal(indenter.profile(*points()), again)


@pytest.mark.parametrize("type_", sorted({"quadric"} | OF_REVOLUTION))
def test_mirror_images_are_equal(type_: str, examples: Examples) -> None:
    """A body with axes along x and y is the same seen in a mirror across either."""
    profile = pl.indenter(type_, **examples["indenter"][type_]).profile(*points())
    np.testing.assert_array_equal(profile[::-1], profile)
    np.testing.assert_array_equal(profile[:, ::-1], profile)


@pytest.mark.parametrize("type_", sorted(OF_REVOLUTION))
def test_bodies_of_revolution_do_not_turn(type_: str, examples: Examples) -> None:
    """Turned by 90°, or by the 3-4-5 triangle's angle, a body of revolution is the same."""
    indenter = pl.indenter(type_, **examples["indenter"][type_])
    x, y = points()
    np.testing.assert_array_equal(indenter.profile(y.T, x.T), indenter.profile(x, y).T)
    circle = 3e-5 * np.array([[3, 4], [5, 0], [0, -5], [-4, 3]])
    heights = indenter.profile(circle[:, :1], circle[:, 1:].T).diagonal()
    np.testing.assert_allclose(heights, heights[0], rtol=1e-14)
