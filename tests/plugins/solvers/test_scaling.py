"""Units of length and pressure, and the number of threads, change neither answer nor effort."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
import scipy.fft

import pellicle as pl
from pellicle import Problem, Solver, State, Stop
from pellicle.arrays import Array
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
        """Return the problem in SI."""
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
