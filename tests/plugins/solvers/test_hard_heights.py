"""Heights that change from cell to cell, and contacts that all but fill their period.

Operator applications are those on the finest grid; each bound stands next to what was measured.
"""

from dataclasses import replace

import numpy as np
import pytest

import pellicle as pl
from pellicle import Force, Kernel, Problem, Stop
from pellicle.arrays import Array
from pellicle.contact import height_scale, round_off
from pellicle_plugins.solvers.active_set import ActiveSet
from pellicle_plugins.solvers.conjugate_gradient import ConjugateGradient
from tests.plugins.solvers.problems import make, solve

LENGTH, MODULUS = 1e-3, 1e5
PLATE = pl.kernel("bending_skin", reduced_modulus=MODULUS, tension=0.0, bending=5e-8)
SKIN = pl.kernel("tensed_membrane", reduced_modulus=MODULUS, tension=0.05 * LENGTH * MODULUS)
MEMBRANE = pl.kernel("tensed_membrane", reduced_modulus=MODULUS, tension=500 * LENGTH * MODULUS)
SOLID = pl.kernel("half_space", reduced_modulus=MODULUS)
KERNELS = {"half-space": SOLID, "skin": SKIN, "membrane": MEMBRANE, "plate": PLATE}


def noise(shape: tuple[int, int], seed: int = 0) -> Array:
    """Return white noise of a micrometre [m]; 0 is the highest."""
    heights = 1e-6 * np.random.default_rng(seed).normal(size=shape)
    return np.asarray(heights - heights.max())


def assert_solved(problem: Problem, most: int) -> None:
    """Assert that it is solved to 1e-8 within so many applications."""
    solved = solve(problem, ActiveSet())
    assert solved.stop is Stop.DONE
    state = solved.equilibrium
    assert max(state.residual_contact, state.residual_penetration) <= 1e-8
    assert state.residual_load <= 1e-12
    assert solved.applications <= most


@pytest.mark.slow
@pytest.mark.parametrize(
    ("points", "depth", "most"),
    [(64, 0.5e-6, 200), (64, 2e-6, 200), (64, 1e-5, 200), (128, 2e-6, 500)],
)
def test_a_checkerboard_under_a_plate(points: int, depth: float, most: int) -> None:
    """The plate spans the pits; the band that it lifts off the rim is met layer by layer.

    Measured: 98 … 144 and 280 … 315; 256² cells take about twice that, and ten seconds or more.
    """
    i, j = np.indices((points, points))
    heights = np.where((i + j) % 2, -1e-6, 0.0)
    assert_solved(make(points, "free", PLATE, heights, "depth", depth, LENGTH), most)


@pytest.mark.parametrize("depth", [1e-6, 3e-6, 1e-5])
def test_one_wave_on_a_row_of_long_cells_under_a_plate(depth: float) -> None:
    """256 cells a millimetre across each yield as in plane strain: 3 applications."""

    def wave(x: Array, y: Array) -> Array:
        heights = 1e-6 * np.cos(2 * np.pi * x / LENGTH)
        return np.asarray(heights - heights.max())

    assert_solved(make((256, 1), "free", PLATE, wave, "depth", depth, LENGTH), 4)


def test_single_peaks_that_no_coarser_cell_touches_are_seen() -> None:
    """Where no coarse cell is reached in the mean, the highest are pressed: 9 applications."""
    heights = np.full((96, 96), -1e-5)
    heights[::16, ::16] = 0.0
    problem = make(96, "free", SOLID, heights, "depth", 1e-6, LENGTH)
    assert not problem.coarsened().needs_solving
    assert_solved(problem, 11)


@pytest.mark.parametrize("kernel", KERNELS.values(), ids=KERNELS.keys())
@pytest.mark.parametrize(
    "share", [1e-9, 1e-6, *(pytest.param(share, marks=pytest.mark.slow) for share in (1e-3, 1e-2))]
)
def test_white_noise_at_a_depth_near_full_contact(kernel: Kernel, share: float) -> None:
    """The last cells off contact decide the mean pressure: 32 … 72, up to 112 under a plate."""
    heights = noise((128, 128))
    depth = (share - 1) * float(heights.mean())
    problem = make(128, "periodic", kernel, heights, "depth", depth, LENGTH)
    assert_solved(problem, 140 if kernel is PLATE else 90)


@pytest.mark.parametrize("kernel", KERNELS.values(), ids=KERNELS.keys())
@pytest.mark.parametrize("excess", [1e-4, 0.5, 100.0])
def test_white_noise_pressed_to_full_contact(kernel: Kernel, excess: float) -> None:
    """Its pressure is k(q) times the heights and a mean, p̂ = û/G: 5 applications."""
    heights = noise((128, 128))
    problem = make(128, "periodic", kernel, heights, "force", 1.0, LENGTH)
    grid = problem.grid
    q = np.hypot(*grid.wavenumbers())
    q[0, 0] = 1.0
    stiffness = 1 / kernel.compliance(q)
    stiffness[0, 0] = 0.0
    varying = np.fft.irfft2(stiffness * np.fft.rfft2(heights), s=grid.shape)
    expected = varying - (1 + excess) * varying.min()
    load = Force(float(expected.sum()) * grid.cell_area)
    solved = solve(replace(problem, control=load), ActiveSet())
    assert solved.stop is Stop.DONE
    assert solved.applications <= 6
    np.testing.assert_allclose(solved.pressure, expected, rtol=0, atol=1e-6 * expected.max())


@pytest.mark.parametrize("share", [1e-12, 1e-6, 0.1, 0.999])
def test_a_pit_of_one_cell(share: float) -> None:
    """At a depth, the pressure round the only cell off contact is found in 25 … 34."""
    heights = np.zeros((256, 256))
    heights[128, 128] = -1e-6
    depth = -share * float(heights.mean())
    assert_solved(make(256, "periodic", MEMBRANE, heights, "depth", depth, LENGTH), 42)


@pytest.mark.parametrize("solver", [ActiveSet(), ConjugateGradient()], ids=lambda value: value.type)
@pytest.mark.parametrize("pressure", [1e-12, 100.0, 1e12])
@pytest.mark.parametrize("ripple", [0.0, 1e-15])
def test_a_flat_indenter_that_fills_its_period_takes_any_pressure(
    solver: pl.Solver, pressure: float, ripple: float
) -> None:
    """The uniform pressure is exact, and is not judged by what rounding leaves of the depth."""
    # Heights that differ by less than the rounding of the displacement are flat, too.
    wave = pressure / MODULUS * LENGTH
    heights = ripple * wave * np.random.default_rng(0).uniform(size=(48, 40))
    heights -= heights.max()
    problem = make((48, 40), "periodic", SKIN, heights, "force", pressure * LENGTH**2, LENGTH)
    solved = solve(problem, solver)
    assert solved.stop is Stop.DONE
    state = solved.equilibrium
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
    heights = noise((64, 64))
    problem = make(64, "periodic", SOLID, heights, "force", 1.0, LENGTH)
    uneven = 1.0 + 1e5 * noise((64, 64), seed=1)
    small, great = (round_off(problem, load * uneven) for load in (1e2, 1e6))
    moved = float(np.abs(problem.operator(1e6 * uneven)).max()) / float(np.ptp(heights))
    assert great == pytest.approx(1e4 * small, rel=0.8)
    assert 1e-17 * moved < great < 1e-13 * moved


def test_a_tolerance_below_round_off_is_said_to_be() -> None:
    """A load so high that rounding moves the surface by more than the tolerance ends as such."""
    load = 1e8 * LENGTH**2 * MODULUS
    problem = make(64, "periodic", SOLID, noise((64, 64)), "force", load, LENGTH)
    solved = solve(problem, ActiveSet())
    assert solved.stop is Stop.ROUND_OFF
    assert solved.equilibrium.residual_contact > 1e-8
    assert solved.applications < 1000
