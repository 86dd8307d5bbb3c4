"""Either solver against a dense quadratic programme on random small problems.

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

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import brentq, nnls

from pellicle import Grid, Problem, Solver, Stop
from pellicle.arrays import Array
from pellicle.contact import height_scale
from pellicle.contact.problem import Depth, Force
from pellicle.surface import operator_of
from pellicle_plugins.solvers.active_set import ActiveSet
from pellicle_plugins.solvers.conjugate_gradient import ConjugateGradient
from tests.plugins.solvers.problems import skin, solve

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
        """Return the programme of ``problem``."""
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
