"""What every solver keeps: the answer is right, and depends on the problem alone."""

from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle import Problem, Solver, Stop
from pellicle.operators import make_operator

SKIN = {"type": "tensed_membrane", "reduced_modulus": 1e4, "tension": 1.0}
SMOOTH = {
    "grid": {"points": 32, "size": "0.4472 mm", "boundary": "free"},
    "kernel": SKIN,
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
}
ROUGH = {
    "grid": {"points": [32, 24], "size": ["1 mm", "0.75 mm"], "boundary": "periodic"},
    "kernel": SKIN | {"tension": 0.1},
    "indenter": {
        "type": "self_affine",
        "rms_height": "10 um",
        "hurst": 0.7,
        "cutoff_wavelength": "0.125 mm",
        "seed": 5,
    },
}
CASES: dict[str, tuple[dict[str, Any], str, float]] = {
    "free depth": (SMOOTH, "depth", 20e-6),
    "free force": (SMOOTH, "force", 4e-5),
    "periodic depth": (ROUGH, "depth", 15e-6),
    "periodic force": (ROUGH, "force", 3e-4),
    "periodic mean pressure": (ROUGH, "mean_pressure", 400.0),
}
RESIDUALS = [
    "residual_contact",
    "residual_penetration",
    "residual_complementarity",
    "residual_load",
]


@pytest.fixture(params=CASES.values(), ids=CASES.keys())
def case(request: pytest.FixtureRequest) -> tuple[dict[str, Any], str, float]:
    """Return a problem, what is prescribed, and its value."""
    return request.param


def solve(problem: dict[str, Any], solver: Solver, prescribed: str, *values: float) -> Any:
    """Return the last of the load steps, each started from the one before."""
    loading = {prescribed: list(values)}
    result = pl.run(problem | {"solver": solver, "loading": loading}, progress=False)
    return result.dataset.isel(step=-1)


def pressed_paraboloid() -> Problem:
    """Return the smooth problem as a solver sees it."""
    run = pl.Run(**SMOOTH, loading={"depth": 20e-6})
    profile = run.indenter.profile(*run.grid.coordinates())
    return Problem(run.grid, make_operator(run.kernel, run.grid), profile, "depth", 20e-6)


def assert_same_pressure(first: Any, second: Any) -> None:
    """Assert that two solutions are equal to what the residuals allow."""
    expected = second["pressure"].values
    np.testing.assert_allclose(first["pressure"].values, expected, atol=1e-5 * expected.max())


def test_solves_what_is_prescribed(solver: Solver, case: tuple[Any, str, float]) -> None:
    """By the residuals of a fresh operator application, pressure, gap and load are right."""
    problem, prescribed, value = case
    step = solve(problem, solver, prescribed, value)
    assert step["converged"].item()
    assert max(step[name].item() for name in RESIDUALS) <= solver.tolerance
    assert step[prescribed].item() == pytest.approx(value, rel=solver.tolerance)
    assert step["pressure"].values.min() == 0
    assert 0.02 < step["contact_fraction"].item() < 0.9


@pytest.mark.parametrize("before", [0.3, 2.0])
def test_start_does_not_matter(solver: Solver, case: tuple[Any, str, float], before: float) -> None:
    """Loaded from below or unloaded from above, a step ends where it ends from scratch."""
    problem, prescribed, value = case
    warm = solve(problem, solver, prescribed, before * value, value)
    assert_same_pressure(warm, solve(problem, solver, prescribed, value))


def test_pressure_is_proportional_to_the_stiffness(
    solver: Solver, case: tuple[Any, str, float]
) -> None:
    """Modulus and tension twice as high double the pressure and leave the shape."""
    problem, prescribed, value = case
    stiff = {key: 2 * v if key != "type" else v for key, v in problem["kernel"].items()}
    factor = 1 if prescribed == "depth" else 2
    doubled = solve(problem | {"kernel": stiff}, solver, prescribed, factor * value)
    single = solve(problem, solver, prescribed, value)
    assert_same_pressure(doubled, 2 * single[["pressure"]])
    assert doubled["depth"].item() == pytest.approx(single["depth"].item(), rel=1e-6)


def test_solution_belongs_to_the_caller(solver: Solver) -> None:
    """The start given to a solver is as it was, and the result is not the same array."""
    problem = pressed_paraboloid()
    start = np.full(problem.grid.shape, 100.0)
    found = solver.solve(problem, start, lambda iteration, residual: None)
    np.testing.assert_array_equal(start, 100.0)
    assert not np.shares_memory(found.pressure, start)
    assert found.stop is Stop.DONE


def test_progress_is_reported(solver: Solver) -> None:
    """The monitor hears of each iteration, the last time with a residual within tolerance."""
    heard: list[tuple[int, float]] = []
    found = solver.solve(pressed_paraboloid(), None, lambda *told: heard.append(told))
    iterations = [iteration for iteration, _ in heard]
    assert iterations == sorted(iterations)
    assert iterations[-1] == found.iterations
    assert heard[-1][1] <= 1 < heard[0][1]
