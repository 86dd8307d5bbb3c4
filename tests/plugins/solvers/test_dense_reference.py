"""Solvers against a dense quadratic programme, in other units and with other threads.

The pressure solves min ½ pᵀAp − pᵀ(δ + f) for p ≥ 0, with A the operator applied to unit pressures.
With A = LLᵀ that is least squares with p ≥ 0, which `scipy.optimize.nnls` solves in finitely many
steps. A periodic A has no stiffness against a uniform pressure; κ times the mean of the pressure is
added to it, which at a given force only shifts the depth. A force, and the depth on a periodic
grid, is met by the root of the force of that programme as a function of its depth.

What is compared: with every gap right to ε, (p − p*)ᵀA(p − p*) ≤ ε Σ(p + p*) whatever the
conditioning of A, as p*, p and the gap of p* are not negative. Single pressures are not, as they
are as much worse as A is ill-conditioned.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import pytest
import scipy.fft
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import brentq, nnls

import pellicle as pl
from pellicle import Grid, Problem, Solver, State, Stop
from pellicle.arrays import Array
from pellicle.contact import height_scale
from pellicle.contact.problem import Depth, Force
from pellicle.surface import operator_of
from pellicle_plugins.solvers.active_set import ActiveSet
from pellicle_plugins.solvers.conjugate_gradient import ConjugateGradient
from pellicle_plugins.solvers.multilevel_extension import Extension
from tests.plugins.solvers.problems import (
    BOUNDARIES,
    Boundary,
    Prescribed,
    make,
    paraboloid,
    rough,
    skin,
    solve,
)

TOLERANCE = 1e-9
# The programme's own round-off, in the same measure as the tolerance.
ROUND_OFF = 1e-11


@dataclass(frozen=True)
class Programme:
    """The dense form of a problem, on the cells where there is an indenter."""

    matrix: Array
    profile: Array
    kappa: float
    factor: Array

    @classmethod
    def of(cls, problem: Problem) -> Programme:
        solid = np.flatnonzero(np.isfinite(problem.profile))
        unit = np.zeros(problem.grid.shape)
        columns = []
        for cell in solid:
            unit.flat[cell] = 1.0
            columns.append(problem.operator(unit).ravel()[solid])
            unit.flat[cell] = 0.0
        matrix = np.array(columns)
        matrix = (matrix + matrix.T) / 2
        kappa = 0.0 if problem.operator.has_mean_compliance else float(matrix.diagonal().mean())
        factor = cholesky(matrix + kappa, lower=True)
        return cls(matrix, problem.profile.ravel()[solid], kappa, factor)

    def pressure(self, depth: float) -> Array:
        """Return the pressure [Pa] at a depth [m] that κ Σp is a part of."""
        wanted = solve_triangular(self.factor, depth + self.profile, lower=True)
        return np.asarray(nnls(self.factor.T, wanted, maxiter=100 * wanted.size)[0])

    def solve(self, problem: Problem) -> tuple[Array, float]:
        """Return pressure [Pa] and depth [m] of the problem."""
        least = -float(self.profile.max())

        def excess(depth: float) -> float:
            if depth <= least:  # Nothing touches; nnls may fail where all its slopes are 0.
                return -1.0
            total = float(self.pressure(depth).sum())
            if problem.prescribed == "force":
                return total * problem.grid.cell_area / problem.value - 1
            return (depth - self.kappa * total) / problem.value - 1

        depth = problem.value
        if problem.prescribed == "force" or self.kappa:
            reach = float(np.ptp(self.profile)) or 1.0
            while excess(least + reach) < 0:
                reach *= 4
            depth = float(brentq(excess, least, least + reach, xtol=1e-15 * reach, rtol=1e-15))
        pressure = self.pressure(depth)
        return pressure, depth - self.kappa * float(pressure.sum())


@st.composite
def problems(draw: st.DrawFn) -> Problem:
    """Return a problem of 3 to 9 cells each way."""
    points = draw(st.tuples(st.integers(3, 9), st.integers(3, 9)))
    aspect = draw(st.sampled_from([1.0, 0.5, 3.0]))
    boundary: Literal["free", "periodic"] = draw(st.sampled_from(["free", "periodic"]))
    tension = draw(st.sampled_from([0.0, 1e-3, 0.1, 1.0, 10.0, 1e3]))
    form = draw(st.sampled_from(["noise", "plateaus", "bowl", "waves", "ramp"]))
    holes = draw(st.sampled_from([0.0, 0.0, 0.2, 0.6]))
    prescribed: Literal["depth", "force"] = draw(st.sampled_from(["depth", "force"]))
    load = draw(st.sampled_from([1e-3, 0.03, 0.2, 0.5, 0.9, 0.99]))
    random = np.random.default_rng(draw(st.integers(0, 2**20)))
    size = (float(points[0]), aspect * points[1])
    grid = Grid(points=points, size=size, boundary=boundary)
    operator = operator_of(skin(2 * tension), grid)
    profile = _profile(form, grid, random)
    solid = random.uniform(size=grid.shape) >= holes
    solid.flat[random.integers(solid.size)] = True
    profile = np.where(solid, profile, -np.inf)
    # Against the mean plane no load reaches further than the mean of the profile.
    lowest, furthest = -float(profile.max()), -float(profile[solid].mean())
    value = lowest + load * (furthest - lowest)
    if prescribed == "force" or value <= lowest:
        return Problem(grid, operator, profile, Force(grid.area * load / (1 - load)))
    return Problem(grid, operator, profile, Depth(value))


def _profile(form: str, grid: Grid, random: np.random.Generator) -> Array:
    x, y = grid.coordinates()
    if form == "noise":
        heights = random.normal(size=grid.shape)
    elif form == "plateaus":
        heights = random.integers(0, 4, size=grid.shape).astype(np.float64)
    elif form == "bowl":
        heights = -((x - random.uniform(-1, 1)) ** 2) - random.uniform(0.1, 3) * y**2
    elif form == "waves":
        heights = np.cos(x * random.uniform(0, 3)) * np.cos(y * random.uniform(0, 3))
    else:
        heights = random.uniform(-1, 1) * x + random.uniform(-1, 1) * y
    return np.asarray(heights - heights.max())


def assert_solved(problem: Problem, solver: Solver) -> None:
    """Assert that a solver finds what the programme finds."""
    solved = solve(problem, solver)
    assert solved.stop is Stop.DONE
    state = solved.equilibrium
    scale = height_scale(problem.profile, state.contact, state.depth)
    assert max(state.residual_contact, state.residual_penetration) <= TOLERANCE
    assert state.residual_load <= 1e-12

    programme = Programme.of(problem)
    expected, depth = programme.solve(problem)
    stiffest = float(np.abs(programme.profile).max() + abs(depth))
    gap = programme.matrix @ expected - programme.profile - depth
    assert np.abs(gap[expected > 0]).max() <= ROUND_OFF * stiffest
    assert gap.min() >= -ROUND_OFF * stiffest

    pressure = solved.pressure[np.isfinite(problem.profile)]
    assert pressure.sum() == pytest.approx(solved.pressure.sum(), rel=1e-15)
    error = pressure - expected
    total = float(pressure.sum() + expected.sum())
    allowed = (TOLERANCE * scale + ROUND_OFF * stiffest) * total
    assert error @ programme.matrix @ error <= allowed
    assert state.depth == pytest.approx(depth, abs=np.sqrt(TOLERANCE) * stiffest)


@pytest.mark.slow
@settings(max_examples=500, deadline=None, derandomize=True)
@given(problem=problems())
def test_active_set(problem: Problem) -> None:
    """On 500 random problems `active_set` finds what the quadratic programme finds."""
    assert_solved(problem, ActiveSet(tolerance=TOLERANCE))


@settings(max_examples=100, deadline=None, derandomize=True)
@given(problem=problems())
def test_conjugate_gradient(problem: Problem) -> None:
    """On 100 random problems `conjugate_gradient` finds what the quadratic programme finds."""
    assert_solved(problem, ConjugateGradient(tolerance=TOLERANCE))


POINTS = 32


def kernels(length: float, modulus: float) -> dict[str, dict[str, Any]]:
    """Return every kernel at a length [m] and a modulus [Pa]; their ratios stay."""
    solid = {"reduced_modulus": modulus}
    layer = solid | {"poissons_ratio": 0.3, "thickness": 0.2 * length}
    tension = 0.05 * modulus * length
    surface = {"poissons_ratio": 0.3, "surface_stiffness": 2 * tension, "tension": tension}
    springs = {"type": "winkler", "foundation": modulus / length}
    return {
        "half_space": solid,
        "tensed_membrane": solid | {"tension": tension},
        "bending_skin": solid | {"tension": 0.0, "bending": 1e-5 * modulus * length**3},
        "bonded_layer": layer,
        "frictionless_layer": layer,
        "layered": {
            "layers": [
                {"reduced_modulus": 50 * modulus, "poissons_ratio": 0.3, "thickness": length / 50},
                {"reduced_modulus": modulus, "poissons_ratio": 0.5, "thickness": length / 5},
            ],
            "substrate": {"reduced_modulus": modulus / 10, "poissons_ratio": 0.4},
        },
        "gurtin_murdoch": solid | surface,
        "winkler": {"foundation": modulus / length},
        "coated": {"substrate": springs, "tension": tension},
    }


@dataclass(frozen=True)
class Case:
    """A paraboloid in units of the length, the modulus and the share of both that it is pressed."""

    kernel: str
    boundary: Boundary
    prescribed: Prescribed
    share: float = 1e-3

    def problem(self, length: float, modulus: float) -> Problem:
        kernel = pl.kernel(self.kernel, **kernels(length, modulus)[self.kernel])

        def heights(x: Array, y: Array) -> Array:
            return -10 * self.share * length * ((x / length) ** 2 + (y / length) ** 2)

        value = 0.01 * self.share * modulus * length * length
        problem = make(POINTS, self.boundary, kernel, heights, self.prescribed, value, length)
        if self.prescribed == "depth":
            depth = pl.Depth(-0.4 * float(problem.profile.mean()))
            problem = replace(problem, control=depth)
        return problem


def solved(case: Case, solver: Solver, length: float, modulus: float) -> tuple[Any, ...]:
    """Return applications, the relative force and depth, and the pressure over the modulus."""
    found = solve(case.problem(length, modulus), solver)
    assert found.stop is Stop.DONE
    state = found.equilibrium
    assert max(state.residual_contact, state.residual_penetration) <= solver.tolerance
    force = state.force / (modulus * length**2 * case.share)
    return found.applications, force, state.depth / (length * case.share), found.pressure / modulus


SCALES = [(1e-15, 1e-6), (1e-10, 1e15), (1e9, 1e15)]
SOLVERS: list[Solver] = [ActiveSet(), ConjugateGradient()]


@pytest.mark.parametrize("solver", SOLVERS, ids=lambda solver: solver.type)
@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("prescribed", ["depth", "force"])
@pytest.mark.parametrize("share", [1e-12, 1e-3])
def test_a_contact_takes_the_same_in_every_unit(
    solver: Solver, boundary: Boundary, prescribed: Prescribed, share: float
) -> None:
    """From 1e-15 to 1e9 m and 1e-6 to 1e15 Pa, also where the indenter is nearly flat."""
    case = Case("tensed_membrane", boundary, prescribed, share)
    applications, force, depth, pressure = solved(case, solver, 1.0, 1.0)
    for length, modulus in SCALES:
        scaled = solved(case, solver, length, modulus)
        assert abs(scaled[0] - applications) <= 3
        assert scaled[1:3] == pytest.approx((force, depth), rel=1e-7)
        np.testing.assert_allclose(scaled[3], pressure, atol=1e-6 * pressure.max(), rtol=0)


@pytest.mark.parametrize("kernel", kernels(1.0, 1.0))
@pytest.mark.parametrize("boundary", BOUNDARIES)
def test_every_kernel_is_solved_in_every_unit(kernel: str, boundary: Boundary) -> None:
    """The force of a depth scales as its dimension says, whatever the kernel."""
    case = Case(kernel, boundary, "depth")
    applications, force, depth, _ = solved(case, ActiveSet(), 1.0, 1.0)
    for length, modulus in SCALES:
        scaled = solved(case, ActiveSet(), length, modulus)
        assert abs(scaled[0] - applications) <= 3
        assert scaled[1:3] == pytest.approx((force, depth), rel=1e-6)


@pytest.mark.parametrize("solver", SOLVERS, ids=lambda solver: solver.type)
def test_stiffness_of_a_contact_scales_as_its_dimension(solver: Solver) -> None:
    """The punch pressure per depth over modulus and length is the same number."""
    contact = np.zeros((POINTS, POINTS), dtype=bool)
    contact[9:22, 12:20] = True
    expected = None
    for length, modulus in [(1.0, 1.0), *SCALES]:
        problem = Case("tensed_membrane", "free", "depth").problem(length, modulus)
        state = State(contact.astype(np.float64), contact.astype(np.float64), 0.0)
        pressure = solver.response(problem, state, lambda iteration, ratio: None)
        share = pressure * (length / modulus)
        expected = share if expected is None else expected
        np.testing.assert_allclose(share, expected, rtol=0, atol=1e-6 * expected.max())


@pytest.mark.parametrize("solver", SOLVERS, ids=lambda solver: solver.type)
@pytest.mark.parametrize("value", [1e-30, 1e-100])
@pytest.mark.parametrize("prescribed", ["depth", "force"])
def test_a_load_just_above_nothing_is_solved(
    solver: Solver, value: float, prescribed: Prescribed
) -> None:
    """It touches with the lowest cell, also after a step of a far larger load."""
    problem = make(33, "free", skin(0.0), paraboloid, prescribed, value)
    for start in (None, np.full(problem.grid.shape, 1e-2)):
        found = solve(problem, solver, start)
        assert found.stop is Stop.DONE
        assert np.count_nonzero(found.equilibrium.contact) == 1
        assert getattr(found.equilibrium, prescribed) == pytest.approx(value, rel=1e-8)


@pytest.mark.parametrize("boundary", ["periodic", pytest.param("free", marks=pytest.mark.slow)])
def test_solutions_have_the_same_bits(boundary: Boundary) -> None:
    """Grids large enough that threads share every pass; 600 points end in a shorter block."""
    prescribed: Prescribed = "force" if boundary == "periodic" else "depth"
    points = 600 if boundary == "periodic" else 512
    problem = make(points, boundary, skin(0.02), rough(0.05), prescribed, 0.02)
    pressures = []
    for threads in (1, 2, 3):
        with scipy.fft.set_workers(threads):
            pressures.append(solve(problem, ActiveSet(tolerance=1e-6)).pressure)
    assert 0.001 < (pressures[0] > 0).mean() < 0.9
    np.testing.assert_array_equal(pressures[1], pressures[0])
    np.testing.assert_array_equal(pressures[2], pressures[0])


@pytest.mark.slow
@pytest.mark.parametrize("orders", [[1.0] * 5, [4.0, 4.0, 3.0, 2.0, 1.0]])
def test_extensions_have_the_same_bits(orders: list[float]) -> None:
    """E and its transpose, with and without the sweeps of skins that bend."""
    generator = np.random.default_rng(0)
    known = generator.random((768, 544)) < 0.2
    extension = Extension(known, orders, stretch=(1.2, 0.8))
    values = np.where(known, generator.normal(size=known.shape), 0).astype(np.float32)
    force = generator.normal(size=known.shape).astype(np.float32)
    results = []
    for threads in (1, 2, 3):
        with scipy.fft.set_workers(threads):
            applied = extension.apply(values.copy())
            transposed = extension.apply_transpose(force.copy())
        results.append(np.stack([applied, np.where(known, transposed, 0)]))
    # The transpose is exact: ⟨E v, f⟩ = ⟨v, Eᵀ f⟩.
    applied, transposed = results[0].astype(np.float64)
    scale = np.linalg.norm(applied) * np.linalg.norm(force)
    assert abs((applied * force).sum() - (values * transposed).sum()) < 1e-6 * scale
    np.testing.assert_array_equal(results[1], results[0])
    np.testing.assert_array_equal(results[2], results[0])
