"""Operators: the precision that they work in, and what they count."""

from typing import Literal

import numpy as np
import pytest
import scipy.fft
from numpy.typing import NDArray

import pellicle as pl
from pellicle import Grid
from pellicle.surface import operator_of
from pellicle_plugins.kernels.half_spaces import TensedMembrane


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_single_precision(boundary: Literal["free", "periodic"]) -> None:
    """A pressure in single precision gives what one in double does, to six digits and less."""
    grid = Grid(points=(40, 33), size=(1.0, 0.8), boundary=boundary)
    operator = operator_of(TensedMembrane(reduced_modulus=1.0, tension=0.02), grid)
    pressure = np.random.default_rng(1).uniform(size=grid.shape)
    exact = operator(pressure)
    rough = operator(pressure.astype(np.float32))
    assert exact.dtype == np.float64
    assert rough.dtype == np.float32
    assert 0 < np.abs(rough - exact).max() < 3e-6 * np.abs(exact).max()
    np.testing.assert_array_equal(operator(pressure), exact)
    assert operator.applications == 3


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_a_scaled_operator_keeps_every_digit(boundary: Literal["free", "periodic"]) -> None:
    """By a power of two; both count together, and the coarser one is scaled as well."""
    grid = Grid(points=16, size=1e-12, boundary=boundary)
    kernel = TensedMembrane(reduced_modulus=1e9, tension=2e-5)
    operator = operator_of(kernel, grid)
    relative = operator.scaled(1 / operator.unit)
    pressure = np.random.default_rng(1).uniform(size=grid.shape)
    np.testing.assert_array_equal(relative(pressure) * operator.unit, operator(pressure))
    assert operator.applications == relative.applications == 2
    assert relative.unit == 1
    assert 1 <= relative.greatest < 2
    wave = np.array([np.pi / 1e-13])
    assert relative.symbol(wave, 0 * wave) * operator.unit == kernel.compliance(wave)
    coarse = operator_of(kernel, grid.coarsened())
    assert relative.coarsened().greatest * operator.unit == coarse.greatest


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_every_row_is_visited_once(boundary: Literal["free", "periodic"], threads: int) -> None:
    """With the final displacement: in other units, with a spring, in place, on two threads."""
    grid = Grid(points=(600, 520), size=(1.5, 1.3), boundary=boundary)
    operator = operator_of(TensedMembrane(reduced_modulus=3.0, tension=0.01), grid)
    operator = operator.scaled(3.0).with_spring(0.7)
    pressure = np.random.default_rng(0).standard_normal(grid.shape)
    expected = operator(pressure)
    visits, copied = np.zeros(grid.shape[0], dtype=int), np.zeros(grid.shape)

    def visit(displacement: NDArray[np.float64], rows: slice) -> None:
        visits[rows] += 1
        copied[rows] = displacement[rows]

    with scipy.fft.set_workers(threads):
        operator(pressure, out=pressure, visit=visit)
    assert (visits == 1).all()
    np.testing.assert_array_equal(copied, expected)
    np.testing.assert_array_equal(pressure, expected)


def test_a_periodic_wave_is_displaced_by_the_compliance() -> None:
    """Each wave of pressure displaces by G(q) times the wave, a uniform one by G(0)."""
    kernel = pl.kernel("bonded_layer", reduced_modulus=1.0, poissons_ratio=0.3, thickness=0.1)
    grid = Grid(points=[32, 18], size=[1.0, 0.7], boundary="periodic")
    operator = operator_of(kernel, grid)
    x, y = grid.coordinates()
    for m, n in ((1, 0), (0, 3), (5, 2), (8, 4)):
        qx, qy = 2 * np.pi * m / grid.size[0], 2 * np.pi * n / grid.size[1]
        wave = np.cos(qx * x + qy * y + 0.3)
        expected = kernel.compliance(np.array([np.hypot(qx, qy)])) * wave
        np.testing.assert_allclose(operator(wave), expected, atol=1e-9 * np.abs(expected).max())
    uniform = operator(np.full(grid.shape, 3.0))
    np.testing.assert_allclose(uniform, 3.0 * kernel.mean_compliance(), rtol=1e-12)
