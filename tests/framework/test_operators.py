"""Influence coefficients, what operators count, and kernels whose symbol differs along x and y."""

from collections.abc import Callable
from typing import Annotated, Literal

import numpy as np
import pytest
import scipy.fft
from numpy.typing import NDArray
from pydantic import Field

import pellicle as pl
from pellicle import Grid
from pellicle.arrays import Array
from pellicle.components import KernelOf
from pellicle.components.rules import CHEAP, Case, first_violation
from pellicle.contact import measure
from pellicle.surface import along_axes, operator_of
from pellicle.surface.influence import cell_coefficients
from pellicle.testing.kernels import runs_converge
from pellicle_plugins.kernels.half_spaces import TensedMembrane
from pellicle_plugins.solvers.bending.few_cells import solved_on_few_cells
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


class Grained(pl.Kernel):
    """Half-space under a skin that is tensed along a grain alone."""

    type: Literal["grained"] = "grained"
    tension: Annotated[float, Field(description="tension along the grain [N/m]")] = 0.1
    angle: Annotated[float, Field(description="direction of the grain [rad]")] = 0.0
    odd: Annotated[float, Field(description="what breaks its symmetry")] = 0.0

    def symbol(self, qx: Array, qy: Array) -> Array:
        """Return 1/(E*|q|/2 + τ₀ q∥²) [m/Pa], with E* = 10 kPa."""
        along = qx * np.cos(self.angle) + qy * np.sin(self.angle)
        stiffness: Array = 5e3 * np.hypot(qx, qy) + self.tension * along**2
        return (1 + self.odd * (qx > 0)) / stiffness


GRID = pl.Grid(points=[24, 16], size=["1 mm", "0.7 mm"], boundary="periodic")


def test_a_class_of_one_compliance_is_told_its_base() -> None:
    """As soon as the class is made; on other kernels too."""
    for base in (pl.Kernel, KernelOf):
        with pytest.raises(pl.PluginError, match=r"Old has compliance\(q\) .* pellicle\.Isotropic"):
            type(
                "Old",
                (base,),
                {"__module__": __name__, "compliance": lambda self, q: 1 / q},
            )


@pytest.mark.parametrize("angle", [0.0, 0.4, np.pi / 2])
def test_each_wave_is_displaced_by_its_symbol(angle: float) -> None:
    """Whatever its direction; mirrored waves by that of their own."""
    kernel = Grained(angle=angle)
    operator = operator_of(kernel, GRID)
    x, y = GRID.coordinates()
    for m, n in ((1, 0), (0, 3), (5, 2), (-5, 2), (3, -4)):
        qx, qy = 2 * np.pi * m / GRID.size[0], 2 * np.pi * n / GRID.size[1]
        wave = np.cos(qx * x + qy * y + 0.3)
        expected = kernel.symbol(np.array([qx]), np.array([qy])) * wave
        np.testing.assert_allclose(operator(wave), expected, atol=1e-9 * np.abs(expected).max())


def test_the_operator_is_symmetric_with_the_shortest_waves() -> None:
    """Waves of two cells have no direction along their axis."""
    operator = operator_of(Grained(angle=0.4), GRID)
    one, two = np.random.default_rng(1).standard_normal((2, *GRID.shape))
    assert (one * operator(two)).sum() == pytest.approx((two * operator(one)).sum(), rel=1e-12)
    turned = operator(one[::-1, ::-1])[::-1, ::-1]
    np.testing.assert_allclose(turned, operator(one), atol=1e-12 * np.abs(turned).max())


def test_it_keeps_the_rules_and_its_runs_converge() -> None:
    """Also inside a skin and a solid that relaxes; a symbol that is not even breaks one."""
    case = Case(GRID)
    for kernel in (
        Grained(),
        pl.kernel("coated", tension="0.1 N/m", bending="1e-12 N*m", substrate=Grained(angle=0.4)),
        pl.kernel("viscoelastic", solid=Grained(), relaxation=[{"fraction": 0.5, "time": "1 s"}]),
    ):
        assert first_violation(CHEAP["kernel"], kernel, case) == ""
        assert not kernel.is_isotropic
        runs_converge(kernel)
    assert "symbol_is_even" in first_violation(CHEAP["kernel"], Grained(odd=0.1), case)


@pytest.mark.parametrize("solver", ["active_set", "conjugate_gradient"])
def test_a_contact_is_longer_across_the_grain(solver: str) -> None:
    """A sphere under a skin that is tense along x: the tension carries where the skin is bent."""
    areas = []
    for angle in (0.0, np.pi / 2):
        result = pl.run(
            pl.Run(
                grid=pl.Grid(points=64, size="0.4 mm", boundary="periodic"),
                kernel=Grained(angle=angle, tension=0.5),
                indenter={"type": "paraboloid", "radius": "1 mm"},
                loading={"force": "20 uN"},
                solver={"type": solver},
            ),
            progress=False,
        )
        areas.append(result.dataset["contact"][0].values)
    assert areas[0].any(axis=0).sum() != areas[0].any(axis=1).sum()
    np.testing.assert_array_equal(areas[0], areas[1].T)


def test_few_cells_under_a_bent_skin_know_only_the_point_mirror() -> None:
    """Their matrix is read from one column of the operator, whose mirrors the grain has broken."""
    kernel = pl.kernel("coated", bending="1e-15 N*m", substrate=Grained(angle=0.4, tension=1.0))
    grid = pl.Grid(points=[12, 10], size=["0.1 mm", "90 um"], boundary="periodic")
    operator, unit = operator_of(kernel, grid), np.zeros(grid.shape)
    unit[0, 0] = 1.0
    random = np.random.default_rng(0)
    profile, contact = -1e-7 * random.random(grid.shape), random.random(grid.shape) < 0.2
    problem = pl.Problem(grid, operator, profile - profile.max(), pl.Force(3e-6))
    gap = np.where(contact, 0.0, 1.0)
    found = solved_on_few_cells(problem, operator(unit), contact, 1.0 - gap, gap, 1e-12)
    assert found is not None
    assert (found > 0).sum() > 20
    assert measure(problem, found).residual_contact < 1e-9


def test_it_has_no_free_boundary_and_no_one_compliance() -> None:
    """Both are said in words, as is a scale that needs no direction."""
    kernel = Grained()
    with pytest.raises(pl.ConfigError, match="yields equally in all directions"):
        operator_of(kernel, pl.Grid(points=8, size=1.0))
    with pytest.raises(pl.ConfigError, match="yields differently along x and y"):
        kernel.compliance(np.ones(3))
    q = np.array([2.0])
    mean = 0.5 * (1 / (1e4 + 0.4) + 1 / 1e4)
    assert along_axes(kernel.symbol, q)[0] == pytest.approx(mean, rel=1e-14)
