"""Fields known in sum outside the domain, against closed forms, invariances and a larger domain."""

from __future__ import annotations

import numpy as np
import pytest

import pellicle as pl
from pellicle.surface.plane import PlaneOperator, from_outside

MODULUS = 1e4


def kernel(modulus: float = MODULUS) -> pl.components.Kernel:
    """Return a half-space."""
    return pl.kernel("half_space", reduced_modulus=modulus)


@pytest.mark.parametrize("points", [16, 17, 100])
@pytest.mark.parametrize("edge", [1e-12, 1e-3, 1e6])
def test_displacement_of_the_centre(edge: float, points: int) -> None:
    """It is (π + 2)/(8√2 π E* h) for 1 N spread as r⁻³ outside a square of half-edge h, to 2 %."""
    grid = pl.Grid(points=points, size=edge, boundary="free")
    field = from_outside(kernel(), grid)
    exact = (np.pi + 2) / (8 * np.sqrt(2) * np.pi * MODULUS * edge / 2)
    assert field[points // 2, points // 2] == pytest.approx(exact, rel=0.02)
    # It grows towards the edges, from where the force acts.
    assert field.min() == pytest.approx(field[points // 2, points // 2], rel=1e-3)
    assert field.max() < 3 * field.min()
    np.testing.assert_allclose(field, field[::-1, ::-1].T, rtol=1e-9)


def test_edges_of_different_length() -> None:
    """Exchanging x and y exchanges the field, and the far ends of a long domain displace less."""
    long, high = (
        from_outside(kernel(), pl.Grid(points=points, size=size, boundary="free"))
        for points, size in (((24, 8), (3e-3, 1e-3)), ((8, 24), (1e-3, 3e-3)))
    )
    np.testing.assert_allclose(long, high.T, rtol=1e-9)
    assert long[0, 4] < long[12, 4]


def test_field_within_the_domain_needs_nothing_outside() -> None:
    """With the integral of the domain it is the bare operator; on a periodic grid with any."""
    rng = np.random.default_rng(2)
    for boundary in ("free", "periodic"):
        grid = pl.Grid(points=16, size="1 mm", boundary=boundary)
        operator, pressure = PlaneOperator(kernel(), grid), rng.random(grid.shape)
        inside = float(pressure.sum()) * grid.cell_area
        expected = operator.operator(pressure)
        np.testing.assert_allclose(operator(pressure, inside), expected, rtol=1e-12)
        if boundary == "periodic":
            np.testing.assert_array_equal(operator(pressure, 7 * inside), expected)


def test_part_outside_is_added() -> None:
    """Of (r² + c²)^(−3/2), whose integral is 2π/c, a quarter of the domain gives the same."""
    large = pl.Grid(points=128, size="4 mm", boundary="free")
    small = pl.Grid(points=32, size="1 mm", boundary="free")
    field = (np.hypot(*large.coordinates()) ** 2 + 1e-8) ** -1.5
    inner = np.s_[48:80, 48:80]
    integral = 2 * np.pi / 1e-4
    expected = PlaneOperator(kernel(), large)(field, integral)[inner]
    operator = PlaneOperator(kernel(), small)
    np.testing.assert_allclose(operator(field[inner], integral), expected, rtol=5e-3)
    alone = operator.operator(field[inner])
    assert np.abs(alone / expected - 1).max() > 0.12
