"""Pyramids: their profiles, published forces and symmetries."""

from math import atan, cos, pi

import numpy as np
import pytest
from numpy.typing import NDArray

import pellicle as pl
from pellicle_plugins.indenters.pyramid import Pyramid
from tests.tables_of_runs import pressing, tensed

SLOPE, DEPTH = 0.1, 0.1
POINTS = np.linspace(-2.0, 2.0, 21)
SIDES = pytest.mark.parametrize("sides", [3, 4])


def faces(sides: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return max nₖ·x at points of shape (…, 2)."""
    azimuth = 2 * pi * np.arange(sides) / sides
    return np.asarray(np.max(points @ np.array([np.cos(azimuth), np.sin(azimuth)]), axis=-1))


@SIDES
def test_a_rounded_profile_is_what_a_paraboloid_reaches(sides: int) -> None:
    """It is −min |x − p|²/2R + c max nₖ·p over all p, and far from edges a sharp one, lowered."""
    sharp = Pyramid(half_angle=atan(1 / SLOPE), sides=sides)
    round_ = Pyramid(half_angle=atan(1 / SLOPE), sides=sides, tip_radius=5.0)
    x, y = POINTS[:, None], POINTS[None, :]
    at = np.stack(np.broadcast_arrays(x, y), axis=-1)
    assert sharp.profile(x, y) == pytest.approx(-SLOPE * faces(sides, at), abs=1e-12)
    p = np.stack(np.meshgrid(*2 * [np.linspace(-2.5, 2.5, 201)]), axis=-1).reshape(-1, 2)
    lift = SLOPE * faces(sides, p)
    reached = [[np.min(np.sum((p - q) ** 2, axis=-1) / 10 + lift) for q in row] for row in at]
    # The points p are 0.025 apart.
    assert round_.profile(x, y) == pytest.approx(-np.array(reached), abs=1e-3)
    assert round_.profile(np.zeros(1), np.zeros(1)) == 0


@SIDES
def test_the_angle_of_the_edges(sides: int) -> None:
    """Along an edge the slope is cot of the half-angle of the edges."""
    body = Pyramid(half_angle=1.2, angle_of="edges", sides=sides)
    x, y = cos(pi / sides), np.sin(pi / sides)
    assert body.profile(np.array(x), np.array(y)) == pytest.approx(-1 / np.tan(1.2))


def force(sides: int, points: int, angle: float = 0.0, ratio: float = 0.0) -> float:
    """Return P tan α / E*δ² at a ratio sc/δ."""
    pyramid = {"type": "pyramid", "half_angle": atan(1 / SLOPE), "sides": sides}
    rotated = {"type": "rotated", "part": pyramid, "angle": angle}
    size, skin = 3.2 if ratio <= 1 else 1.7, tensed(1.0, ratio / 2 * DEPTH / SLOPE)
    data = pl.run(pressing(points, size, skin, rotated, depth=DEPTH)).dataset
    return float(data["force"][-1]) * SLOPE / DEPTH**2


def test_four_sides_are_those_of_bilodeau() -> None:
    """His approximate pressure gives 0.7453 E* tan α δ² (1992); the grid converges to 0.7376."""
    coarse, fine = force(4, 64), force(4, 128)
    assert fine == pytest.approx(0.7376, rel=1e-3)
    assert abs(fine - 0.7376) < abs(coarse - 0.7376)
    assert fine == pytest.approx(0.7453, rel=1.2e-2)


def test_three_sides_are_those_of_bilodeau() -> None:
    """His pressure gives 0.887 E* tan α δ² (1992), the grid 0.8824."""
    assert force(3, 128) == pytest.approx(0.8824, rel=1e-3)
    assert force(3, 64) == pytest.approx(0.887, rel=6e-3)


def test_a_turned_pyramid_has_the_same_force() -> None:
    """By 45° and by 90°; three sides are mirrored by a half turn."""
    assert force(4, 128, pi / 4) == pytest.approx(force(4, 128), rel=1e-3)
    assert force(4, 64, pi / 2) == pytest.approx(force(4, 64), rel=1e-9)
    assert force(3, 64, pi) == pytest.approx(force(3, 64), rel=1e-9)


@pytest.mark.parametrize("ratio", [0.0, 0.1, 1.0, 10.0])
@SIDES
def test_the_curve_is_that_of_the_grid(sides: int, ratio: float) -> None:
    """At any s/δ its force is that to which the grid converges, to 0.2 %."""
    pyramid = Pyramid(half_angle=atan(1 / SLOPE), sides=sides)
    curve = pyramid.force_curve(np.array([DEPTH]), ratio * DEPTH / SLOPE)
    coarse, fine = (force(sides, points, ratio=ratio) for points in (64, 128))
    # Under a tension the error is in proportion to the edge of a cell.
    limit = 2 * fine - coarse if ratio else fine
    assert curve.force[0] * SLOPE / DEPTH**2 == pytest.approx(limit, rel=2e-3)


def test_a_rounded_one_has_no_curve() -> None:
    """Its depth limit is 0, by which fits know to simulate it."""
    rounded = Pyramid(half_angle=1.2, tip_radius=20e-9)
    assert rounded.depth_limit == 0
    with pytest.raises(pl.ConfigError, match="no known force curve"):
        rounded.force_curve(np.ones(1), 0.0)
