"""What every solver keeps: the answer is right, and depends on the problem alone."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.components import Solver
from pellicle.components.calls import solution_of
from pellicle.config.run import Run
from pellicle.numerics.operators import make_operator
from pellicle.numerics.problem import Problem, measure, measure_stiffness
from pellicle.numerics.solution import State, Stop

from .component import check
from .rules import Rule, require, require_close
from .runs import solved

if TYPE_CHECKING:
    import xarray as xr

_SKIN = {"type": "tensed_membrane", "reduced_modulus": 1e4, "tension": 1.0}
_SMOOTH: dict[str, Any] = {
    "grid": {"points": 32, "size": "0.4472 mm", "boundary": "free"},
    "kernel": _SKIN,
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
}
_ROUGH: dict[str, Any] = {
    "grid": {"points": [32, 24], "size": ["1 mm", "0.75 mm"], "boundary": "periodic"},
    "kernel": _SKIN | {"tension": 0.1},
    "indenter": {
        "type": "self_affine",
        "rms_height": "10 um",
        "hurst": 0.7,
        "cutoff_wavelength": "0.125 mm",
        "seed": 5,
    },
}
_PUNCH = _SMOOTH | {"indenter": {"type": "flat_punch", "radius": "0.1 mm"}}
_CASES: list[tuple[dict[str, Any], str, float]] = [
    (_SMOOTH, "depth", 20e-6),
    (_SMOOTH, "force", 4e-5),
    (_PUNCH, "depth", 10e-6),
    (_ROUGH, "depth", 15e-6),
    (_ROUGH, "force", 3e-4),
    (_ROUGH, "mean_pressure", 400.0),
]
# How much larger than the gap's the relative error of the pressure may be: the condition of the
# operators above.
_CONDITION = 1e4


def check_solver(solver: Solver) -> None:
    """Check that a solver keeps its contract.

    Beside what all components keep: paraboloid, punch and rough surface, on free and periodic
    grids, with depth, force and mean pressure prescribed, are solved to the solver's
    ``tolerance``, with pressure ≥ 0; the answer depends on neither the step before nor the unit of
    stiffness; arguments are as they were; progress is told; and ``response`` is that of a flat
    punch.

    Raises
    ------
    AssertionError
        It does not; says what was asked and what was found.
    """
    check(solver, "solver", RULES)


def _solve(problem: dict[str, Any], solver: Solver, prescribed: str, *values: float) -> xr.Dataset:
    """Return the last of the load steps, each started from the one before."""
    more = {"solver": solver, "loading": {prescribed: list(values)}}
    return solved(problem | more).isel(step=-1)


@lru_cache(maxsize=len(_CASES))
def _afresh(solver: Solver, case: int) -> xr.Dataset:
    """Return the one step of a case; several rules compare with it."""
    problem, prescribed, value = _CASES[case]
    return _solve(problem, solver, prescribed, value)


def _problems() -> Iterator[Problem]:
    """Yield a smooth problem as a solver sees it, its depth or its force prescribed."""
    for problem, prescribed, value in _CASES[:2]:
        run = Run(**problem, loading={prescribed: value})
        profile = run.indenter.profile(*run.grid.coordinates())
        assert prescribed in ("depth", "force")
        kind: Any = prescribed
        yield Problem(run.grid, make_operator(run.kernel, run.grid), profile, kind, value)


def _ignore(iteration: int, residual: float) -> None:
    pass


def solve_returns_a_solution(solver: Solver) -> None:
    """solve() returns a Solution of real numbers and leaves its problem as it is."""
    for problem in _problems():
        solution_of(solver, problem, None, _ignore)


def pressure_is_nowhere_negative(solver: Solver) -> None:
    """solve() returns a finite pressure ≥ 0 of the grid's shape."""
    for problem in _problems():
        found = solver.solve(problem, None, _ignore).pressure
        require(np.shape(found) == problem.grid.shape, f"shape {np.shape(found)}")
        require(np.isfinite(found).all(), "a pressure that is not finite")
        require(
            found.min() >= 0,
            f"{found.min():g} Pa, with {problem.prescribed} prescribed; the highest is "
            f"{found.max():g} Pa",
        )


def done_means_solved(solver: Solver) -> None:
    """A solver that stops with Stop.DONE has met its tolerance, measured afresh."""
    for problem in _problems():
        found = solver.solve(problem, None, _ignore)
        residual = _residual(problem, found.pressure)
        require(
            found.stop is not Stop.DONE or residual <= solver.tolerance,
            f"Stop.DONE at a residual of {residual:.1e}, over the tolerance "
            f"{solver.tolerance:.1e}, with {problem.prescribed} prescribed",
        )


def _residual(problem: Problem, pressure: Any) -> float:
    found = measure(problem, pressure)
    return max(
        found.residual_contact,
        found.residual_penetration,
        found.residual_complementarity,
        found.residual_load,
    )


def what_is_prescribed_is_solved(solver: Solver) -> None:
    """Pressure, gap and load meet the tolerance, for depth, force and mean pressure."""
    for case, (_, prescribed, value) in enumerate(_CASES):
        require_close(
            _afresh(solver, case)[prescribed].item(),
            value,
            f"the {prescribed}",
            relative=solver.tolerance,
        )


def start_does_not_matter(solver: Solver) -> None:
    """Loaded from below or unloaded from above, a step ends where it ends from scratch."""
    for case, (problem, prescribed, value) in enumerate(_CASES):
        afresh = _afresh(solver, case)
        for before in (0.3, 2.0):
            after = _solve(problem, solver, prescribed, before * value, value)
            _require_same_pressure(after, afresh, 1.0, solver, f"after {before:g} times the load")


def pressure_is_proportional_to_the_stiffness(solver: Solver) -> None:
    """Modulus and tension twice as high double the pressure and leave the shape."""
    for case, (problem, prescribed, value) in enumerate(_CASES):
        kernel = {key: v if key == "type" else 2 * v for key, v in problem["kernel"].items()}
        load = value if prescribed == "depth" else 2 * value
        doubled = _solve(problem | {"kernel": kernel}, solver, prescribed, load)
        single = _afresh(solver, case)
        _require_same_pressure(doubled, single, 2.0, solver, "of twice the stiffness")


def _require_same_pressure(
    found: xr.Dataset, expected: xr.Dataset, factor: float, solver: Solver, what: str
) -> None:
    pressure = factor * expected["pressure"].values
    allowed = _CONDITION * solver.tolerance * float(pressure.max())
    require_close(found["pressure"].values, pressure, f"the pressure [Pa] {what}", absolute=allowed)


def start_belongs_to_the_caller(solver: Solver) -> None:
    """The start given to a solver is as it was, and the result is not the same array."""
    for problem in _problems():
        pressure = np.full(problem.grid.shape, 100.0)
        start = State(pressure, pressure, 0.0)
        profile = problem.profile.copy()
        found = solver.solve(problem, start, _ignore).pressure
        require((pressure == 100.0).all(), "solve() changes start.pressure")
        require(np.array_equal(profile, problem.profile), "solve() changes problem.profile")
        require(not np.shares_memory(found, pressure), "the pressure returned is start.pressure")


def progress_is_told(solver: Solver) -> None:
    """monitor(iteration, residual / tolerance) is called, at the end with the result's."""
    for problem in _problems():
        told: list[tuple[int, float]] = []
        found = solver.solve(problem, None, lambda *each, to=told: to.append(each))
        require(bool(told), "monitor is never called")
        iterations = [iteration for iteration, _ in told]
        require(iterations == sorted(iterations), f"iterations {iterations}")
        require(
            iterations[-1] == found.iterations,
            f"the last iteration told is {iterations[-1]}, that of the result {found.iterations}",
        )
        require(told[-1][1] <= 1, f"the last residual told is {told[-1][1]:g} of the tolerance")


def response_is_that_of_a_flat_punch(solver: Solver) -> None:
    """response() displaces the contact of a state by 1 and acts nowhere else."""
    for problem in _problems():
        contact = problem.profile > 0.1 * problem.profile.min()
        any_pressure = contact.astype(np.float64)
        state = State(any_pressure, any_pressure, 0.0)
        pressure = solver.response(problem, state, _ignore)
        require(np.shape(pressure) == problem.grid.shape, f"shape {np.shape(pressure)}")
        require(not pressure[~contact].any(), "response() presses off the contact")
        require(
            (residual := measure_stiffness(problem, contact, pressure).residual)
            <= solver.tolerance,
            f"response() misses the displacement 1 by {residual:.1e}, over the tolerance "
            f"{solver.tolerance:.1e}",
        )


RULES: list[Rule] = [
    solve_returns_a_solution,
    pressure_is_nowhere_negative,
    done_means_solved,
    start_belongs_to_the_caller,
    response_is_that_of_a_flat_punch,
    what_is_prescribed_is_solved,
    start_does_not_matter,
    pressure_is_proportional_to_the_stiffness,
    progress_is_told,
]
