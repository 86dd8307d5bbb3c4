"""Heights that change from cell to cell, and contacts that all but fill their period.

Operator applications are those on the finest grid; each bound stands next to what was measured.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest

import pellicle as pl
from pellicle import Grid, Kernel, Problem, Solution, Stop
from pellicle.operators import Array, make_operator
from pellicle.problem import height_scale, measure, round_off
from pellicle_plugins.solvers.active_set import ActiveSet
from pellicle_plugins.solvers.conjugate_gradient import ConjugateGradient

LENGTH, MODULUS = 1e-3, 1e5
PLATE = pl.kernel("bending_skin", reduced_modulus=MODULUS, tension=0.0, bending=5e-8)
SKIN = pl.kernel("tensed_membrane", reduced_modulus=MODULUS, tension=0.05 * LENGTH * MODULUS)
MEMBRANE = pl.kernel("tensed_membrane", reduced_modulus=MODULUS, tension=500 * LENGTH * MODULUS)
SOLID = pl.kernel("half_space", reduced_modulus=MODULUS)
KERNELS = {"half-space": SOLID, "skin": SKIN, "membrane": MEMBRANE, "plate": PLATE}


def make(
    kernel: Kernel,
    grid: Grid,
    heights: Array,
    prescribed: Literal["depth", "force"],
    value: float,
) -> Problem:
    """Return the problem of heights [m], wherever their highest is."""
    profile = heights - heights.max()
    control = pl.Depth(value) if prescribed == "depth" else pl.Force(value)
    return Problem(grid, make_operator(kernel, grid), profile, control)


def solve(problem: Problem, tolerance: float = 1e-8) -> tuple[Solution, int]:
    """Return the solution and the operator applications that it took."""
    solution = ActiveSet(tolerance=tolerance).solve(problem, None, lambda iteration, ratio: None)
    return solution, problem.operator.applications


def assert_solved(problem: Problem, most: int) -> None:
    """Assert that it is solved to 1e-8 within so many applications."""
    solution, applications = solve(problem)
    assert solution.stop is Stop.DONE
    state = measure(problem, solution.pressure)
    assert max(state.residual_contact, state.residual_penetration) <= 1e-8
    assert state.residual_load <= 1e-12
    assert applications <= most


@pytest.mark.slow
@pytest.mark.parametrize(
    ("points", "depth", "most"),
    [(64, 0.5e-6, 200), (64, 2e-6, 200), (64, 1e-5, 200), (128, 2e-6, 500)],
)
def test_a_checkerboard_under_a_plate(points: int, depth: float, most: int) -> None:
    """The plate spans the pits; the band that it lifts off the rim is met layer by layer.

    Measured: 98 … 144 and 280 … 315; 256² cells take about twice that, and ten seconds or more.
    """
    grid = Grid(points=points, size=LENGTH, boundary="free")
    i, j = np.indices(grid.shape)
    assert_solved(make(PLATE, grid, np.where((i + j) % 2, -1e-6, 0.0), "depth", depth), most)


@pytest.mark.parametrize("depth", [1e-6, 3e-6, 1e-5])
def test_one_wave_on_a_row_of_long_cells_under_a_plate(depth: float) -> None:
    """256 cells a millimetre across each yield as in plane strain: 3 applications."""
    grid = Grid(points=(256, 1), size=LENGTH, boundary="free")
    x, _ = grid.coordinates()
    assert_solved(make(PLATE, grid, 1e-6 * np.cos(2 * np.pi * x / LENGTH), "depth", depth), 4)


def test_single_peaks_that_no_coarser_cell_touches_are_seen() -> None:
    """Where no coarse cell is reached in the mean, the highest are pressed: 9 applications."""
    grid = Grid(points=96, size=LENGTH, boundary="free")
    heights = np.full(grid.shape, -1e-5)
    heights[::16, ::16] = 0.0
    problem = make(SOLID, grid, heights, "depth", 1e-6)
    assert not problem.coarsened().needs_solving
    assert_solved(problem, 11)


@pytest.mark.parametrize("kernel", KERNELS.values(), ids=KERNELS.keys())
@pytest.mark.parametrize("share", [1e-9, 1e-6, 1e-3, 1e-2, 0.1])
def test_white_noise_at_a_depth_near_full_contact(kernel: Kernel, share: float) -> None:
    """The last cells off contact decide the mean pressure: 32 … 72, up to 112 under a plate."""
    grid = Grid(points=128, size=LENGTH, boundary="periodic")
    heights = 1e-6 * np.random.default_rng(0).normal(size=grid.shape)
    depth = (1 - share) * float(heights.max() - heights.mean())
    assert_solved(make(kernel, grid, heights, "depth", depth), 140 if kernel is PLATE else 90)


@pytest.mark.parametrize("kernel", KERNELS.values(), ids=KERNELS.keys())
@pytest.mark.parametrize("excess", [1e-4, 0.5, 100.0])
def test_white_noise_pressed_to_full_contact(kernel: Kernel, excess: float) -> None:
    """Its pressure is k(q) times the heights and a mean, p̂ = û/G: 5 applications."""
    grid = Grid(points=128, size=LENGTH, boundary="periodic")
    heights = 1e-6 * np.random.default_rng(0).normal(size=grid.shape)
    q = np.hypot(*grid.wavenumbers())
    q[0, 0] = 1.0
    stiffness = 1 / kernel.compliance(q)
    stiffness[0, 0] = 0.0
    varying = np.fft.irfft2(stiffness * np.fft.rfft2(heights), s=grid.shape)
    expected = varying - (1 + excess) * varying.min()
    problem = make(kernel, grid, heights, "force", float(expected.sum()) * grid.cell_area)
    solution, applications = solve(problem)
    assert solution.stop is Stop.DONE
    assert applications <= 6
    np.testing.assert_allclose(solution.pressure, expected, rtol=0, atol=1e-6 * expected.max())


@pytest.mark.parametrize("share", [1e-12, 1e-6, 0.1, 0.999])
def test_a_pit_of_one_cell(share: float) -> None:
    """At a depth, the pressure round the only cell off contact is found in 25 … 34."""
    grid = Grid(points=256, size=LENGTH, boundary="periodic")
    heights = np.zeros(grid.shape)
    heights[128, 128] = -1e-6
    problem = make(MEMBRANE, grid, heights, "depth", -share * float(heights.mean()))
    assert_solved(problem, 42)


@pytest.mark.parametrize("solver", [ActiveSet(), ConjugateGradient()], ids=lambda value: value.type)
@pytest.mark.parametrize("pressure", [1e-12, 100.0, 1e12])
@pytest.mark.parametrize("ripple", [0.0, 1e-15])
def test_a_flat_indenter_that_fills_its_period_takes_any_pressure(
    solver: pl.Solver, pressure: float, ripple: float
) -> None:
    """The uniform pressure is exact, and is not judged by what rounding leaves of the depth."""
    grid = Grid(points=(48, 40), size=LENGTH, boundary="periodic")
    # Heights that differ by less than the rounding of the displacement are flat, too.
    wave = pressure / MODULUS * LENGTH
    heights = ripple * wave * np.random.default_rng(0).uniform(size=grid.shape)
    problem = make(SKIN, grid, heights, "force", pressure * grid.area)
    solution = solver.solve(problem, None, lambda iteration, ratio: None)
    assert solution.stop is Stop.DONE
    state = measure(problem, solution.pressure)
    assert max(state.residual_contact, state.residual_load) <= 1e-8
    np.testing.assert_allclose(state.pressure, pressure, rtol=1e-3 if ripple else 1e-12)


def test_the_height_scale_of_a_flat_indenter_is_no_rounding() -> None:
    """For a flat contact it is the depth, or the displacement of the longest wave if greater."""
    profile = np.zeros((4, 4))
    contact = np.ones((4, 4), dtype=bool)
    assert height_scale(profile, contact, 1e-22, 1e-9) == 1e-9
    assert height_scale(profile, contact, 1e-3, 1e-9) == 1e-3
    profile[0, 0] = -1e-6
    assert height_scale(profile, contact, 1e-22, 1e-9) == 1e-6


def test_round_off_is_measured() -> None:
    """It is a small multiple of the machine's, over the height range, and grows with the load."""
    grid = Grid(points=64, size=LENGTH, boundary="periodic")
    heights = 1e-6 * np.random.default_rng(0).normal(size=grid.shape)
    problem = make(SOLID, grid, heights, "force", 1.0)
    uniform = np.ones(grid.shape)
    uneven = uniform + 0.1 * np.random.default_rng(1).normal(size=grid.shape)
    small, great = (round_off(problem, load * uneven) for load in (1e2, 1e6))
    moved = float(np.abs(problem.operator(1e6 * uneven)).max()) / float(np.ptp(heights))
    assert great == pytest.approx(1e4 * small, rel=0.8)
    assert 1e-17 * moved < great < 1e-13 * moved


def test_a_tolerance_below_round_off_is_said_to_be() -> None:
    """A load so high that rounding moves the surface by more than the tolerance ends as such."""
    grid = Grid(points=64, size=LENGTH, boundary="periodic")
    heights = 1e-6 * np.random.default_rng(0).normal(size=grid.shape)
    problem = make(SOLID, grid, heights, "force", 1e8 * grid.area * MODULUS)
    solution, applications = solve(problem)
    assert solution.stop is Stop.ROUND_OFF
    assert measure(problem, solution.pressure).residual_contact > 1e-8
    assert applications < 1000


class Wandering(ConjugateGradient):
    """Solver that goes nowhere."""

    type: Literal["wandering"] = "wandering"  # type: ignore[assignment]

    def step(self, problem: Problem, state: object) -> object:  # type: ignore[override]
        """Return the state as it is."""
        return state

    def terminate(self, problem: Problem, state: object) -> Stop:
        """Return that it stalls."""
        return Stop.STALLED


def test_a_solver_that_wanders_is_not_said_to_be_at_round_off() -> None:
    """Where the residual is far above rounding, the status does not blame the tolerance."""
    grid = Grid(points=32, size=LENGTH, boundary="free")
    x, y = grid.coordinates()
    problem = make(SOLID, grid, -(x**2 + y**2) / LENGTH, "depth", 1e-5)
    solution = Wandering().solve(problem, None, lambda iteration, ratio: None)
    assert solution.stop is Stop.STALLED
    assert "not because of round-off" in solution.stop.value
