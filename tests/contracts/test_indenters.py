"""Symmetries of our own indenters, beyond the contract."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import pellicle as pl
from pellicle import Grid

Examples = dict[str, dict[str, dict[str, Any]]]
Array = NDArray[np.float64]
GRID = Grid(points=[13, 11], size=["1.3 mm", "1.1 mm"])
OF_REVOLUTION = {"paraboloid", "sphere", "cone", "flat_punch"}


def points() -> tuple[Array, Array]:
    """Return coordinates; one point lies at the origin."""
    return GRID.coordinates()


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
