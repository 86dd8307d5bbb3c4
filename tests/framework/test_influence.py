"""Influence coefficients against references and identities; what operators count."""

from collections.abc import Callable
from typing import Literal

import numpy as np
import pytest
import scipy.fft
from numpy.typing import NDArray

import pellicle as pl
from pellicle import Grid
from pellicle.arrays import Array
from pellicle.surface import operator_of
from pellicle.surface.influence import cell_coefficients
from pellicle_plugins.kernels.half_spaces import TensedMembrane
from tests.tables_of_runs import reference_rows

Radial = Callable[[Array], Array]

# s/D, i, j, K E*/D.
REFERENCE = np.array([[*row.values()] for row in reference_rows("kernel_cells.csv")])
LENGTHS = [0.0, 1e-6, 1e-3, 0.1, 1.0, 10.0, 1e3, 1e6]


def membrane(s: float) -> tuple[Radial, Radial]:
    """G and its radial primitive for E* = 1; s = 0 is the half-space."""
    kernel = TensedMembrane(reduced_modulus=1.0, tension=s / 2)
    return kernel.greens_function, kernel.radial_primitive


def love(x: Array, y: Array) -> Array:
    """Love's corner integral of 1/(pi r) over the rectangle from the origin to (x, y)."""
    return (x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y))) / np.pi


@pytest.mark.parametrize("s", np.unique(REFERENCE[:, 0]))
def test_reference_values(s: float) -> None:
    """Every tabulated coefficient is met to 1e-11."""
    rows = REFERENCE[REFERENCE[:, 0] == s]
    i, j = rows[:, 1].astype(int), rows[:, 2].astype(int)
    coefficients = cell_coefficients(*membrane(s), (1001, 58), (1.0, 1.0))
    np.testing.assert_allclose(coefficients[i, j], rows[:, 3], rtol=1e-11)


@pytest.mark.parametrize("spacing", [(1.0, 1.0), (2.0, 1.0), (0.3, 3.0)])
def test_half_space_equals_loves_closed_form(spacing: tuple[float, float]) -> None:
    """Half-space coefficients of square and slender cells equal Love's rectangle formula."""
    shape = (90, 50)
    x: Array = (np.arange(shape[0] + 1, dtype=np.float64)[:, None] - 0.5) * spacing[0]
    y: Array = (np.arange(shape[1] + 1, dtype=np.float64)[None, :] - 0.5) * spacing[1]
    exact = np.diff(np.diff(love(x, y), axis=0), axis=1)
    coefficients = cell_coefficients(*membrane(0.0), shape, spacing)
    np.testing.assert_allclose(coefficients, exact, rtol=1e-10)


@pytest.mark.parametrize("s", LENGTHS)
def test_three_slender_cells_make_a_square_one(s: float) -> None:
    """Cells of sides 1/3 and 1, summed in threes, give the square cells at all distances."""
    square = cell_coefficients(*membrane(s), (60, 50), (1.0, 1.0))
    slender = cell_coefficients(*membrane(s), (180, 50), (1 / 3, 1.0))
    middle = 3 * np.arange(60)
    total = sum(slender[np.abs(middle + a)] for a in (-1, 0, 1))
    np.testing.assert_allclose(total, square, rtol=3e-11)


@pytest.mark.parametrize("spacing", [(1.0, 1.0), (1.0, 4.0), (10.0, 1.0)])
@pytest.mark.parametrize("s", LENGTHS)
def test_blocks_of_nine_cells_make_the_large_cell(s: float, spacing: tuple[float, float]) -> None:
    """Sums over 3 x 3 cells equal the cells three times as large, across all tier borders."""
    coarse_shape = (40, 36)
    large = (3 * spacing[0], 3 * spacing[1])
    coarse = cell_coefficients(*membrane(s), coarse_shape, large)
    fine = cell_coefficients(*membrane(s), (120, 108), spacing)
    i, j = 3 * np.arange(40), 3 * np.arange(36)
    steps = (-1, 0, 1)
    total = sum(fine[np.ix_(np.abs(i + a), np.abs(j + b))] for a in steps for b in steps)
    np.testing.assert_allclose(total, coarse, rtol=3e-11)


@pytest.mark.parametrize("shape", [(70, 70), (90, 41), (41, 90), (1, 60), (60, 1), (1, 1)])
def test_symmetric_short_cut_equals_full_evaluation(shape: tuple[int, int]) -> None:
    """Square cells equal cells that are square but for rounding, which take the full route."""
    short = cell_coefficients(*membrane(2.0), shape, (1.0, 1.0))
    full = cell_coefficients(*membrane(2.0), shape, (1.0, float(np.nextafter(1.0, 2.0))))
    assert short.shape == shape
    np.testing.assert_allclose(short, full, rtol=2e-13)


@pytest.mark.parametrize("spacing", [(1.0, 1.0), (1.0, 3.0)])
def test_small_grids_are_corners_of_large_ones(spacing: tuple[float, float]) -> None:
    """The number of offsets asked for does not change the coefficients."""
    large = cell_coefficients(*membrane(3.0), (400, 350), spacing)
    for shape in [(1, 1), (3, 7), (200, 5), (9, 340), (50, 50)]:
        small = cell_coefficients(*membrane(3.0), shape, spacing)
        np.testing.assert_allclose(small, large[: shape[0], : shape[1]], rtol=2e-13)


def test_vanishing_tension_tends_to_the_half_space() -> None:
    """A tiny s lowers the loaded cell by 2 s/E* and leaves the others, to second order in s."""
    s = 1e-6
    tensed = cell_coefficients(*membrane(s), (60, 40), (1.0, 1.0))
    bare = cell_coefficients(*membrane(0.0), (60, 40), (1.0, 1.0))
    assert (bare[0, 0] - tensed[0, 0]) / (2 * s) == pytest.approx(1, abs=1e-5)
    tensed[0, 0] = bare[0, 0]
    np.testing.assert_allclose(tensed, bare, rtol=2e-11)


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
