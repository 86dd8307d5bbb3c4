"""Contract rules of solvers: the solution is right and depends on the problem alone."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import xarray as xr

from pellicle.components import Solver
from pellicle.components.calls import response_of
from pellicle.config.run import Run
from pellicle.contact.equilibrium import measure_stiffness
from pellicle.contact.problem import Depth, Force, Problem
from pellicle.contact.solution import State
from pellicle.surface.from_kernel import operator_of

from .component import check, require, require_close, rules_of
from .small_runs import PARABOLOID, ROUGH, ignore, solve_small_run

_SKIN = {"type": "tensed_membrane", "reduced_modulus": 1e4, "tension": 1.0}
_SMOOTH: dict[str, Any] = {
    "grid": {"points": 32, "size": "0.4472 mm", "boundary": "free"},
    "kernel": _SKIN,
    "indenter": PARABOLOID,
}
_ROUGH: dict[str, Any] = {
    "grid": {"points": [32, 24], "size": ["1 mm", "0.75 mm"], "boundary": "periodic"},
    "kernel": _SKIN | {"tension": 0.1},
    "indenter": ROUGH,
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
# The condition number of the operators above: the relative error of the pressure may exceed that
# of the gap by this factor.
_CONDITION = 1e4


def check_solver(solver: Solver) -> None:
    """Check that a solver keeps its contract: the rules below, and those of all components."""
    check(solver, Solver, rules_of(__name__))


def _solve(problem: dict[str, Any], solver: Solver, prescribed: str, *values: float) -> xr.Dataset:
    """Return the last of several load steps, each started from the one before."""
    return solve_small_run(**problem, solver=solver, loading={prescribed: list(values)}).isel(
        step=-1
    )


@lru_cache(maxsize=len(_CASES))
def _from_scratch(solver: Solver, case: int) -> xr.Dataset:
    """Return the only step of a case; several rules compare with it."""
    problem, prescribed, value = _CASES[case]
    return _solve(problem, solver, prescribed, value)


def _problems() -> list[Problem]:
    run = Run(**_SMOOTH, loading={"depth": 0.0})
    operator = operator_of(run.kernel, run.grid)
    profile = run.indentation.indenter.profile(*run.grid.coordinates())
    return [
        Problem(run.grid, operator, profile, control) for control in (Depth(20e-6), Force(4e-5))
    ]


def response_is_that_of_a_flat_punch(solver: Solver) -> None:
    """response() displaces the contact of a state by 1 and acts nowhere else."""
    for problem in _problems():
        contact = problem.profile > 0.1 * problem.profile.min()
        pressed = contact.astype(np.float64)
        pressure = response_of(solver, problem, State(pressed, pressed, 0.0), ignore)
        residual = measure_stiffness(problem, contact, pressure).residual
        what = f"response() misses the displacement 1 by {residual:.1e}"
        require(residual <= solver.tolerance, what)


def _require_same_pressure(
    result: xr.Dataset, case: int, factor: float, solver: Solver, what: str
) -> None:
    pressure = factor * _from_scratch(solver, case)["pressure"].values
    allowed = _CONDITION * solver.tolerance * float(pressure.max())
    require_close(
        result["pressure"].values, pressure, f"the pressure [Pa] {what}", absolute=allowed
    )


def prescribed_values_are_met(solver: Solver) -> None:
    """Pressure, gap and load meet the tolerance, for depth, force and mean pressure."""
    for case, (_, prescribed, value) in enumerate(_CASES):
        result = _from_scratch(solver, case)[prescribed].item()
        require_close(result, value, f"the {prescribed}", relative=solver.tolerance)


def start_does_not_matter(solver: Solver) -> None:
    """Loaded from below or unloaded from above, a step ends where it ends from scratch."""
    for case, (problem, prescribed, value) in enumerate(_CASES):
        for before in (0.3, 2.0):
            after = _solve(problem, solver, prescribed, before * value, value)
            _require_same_pressure(after, case, 1.0, solver, f"after {before:g} times the load")


def pressure_is_proportional_to_the_stiffness(solver: Solver) -> None:
    """Modulus and tension twice as high double the pressure and leave the shape."""
    for case, (problem, prescribed, value) in enumerate(_CASES):
        kernel = {key: v if key == "type" else 2 * v for key, v in problem["kernel"].items()}
        load = value if prescribed == "depth" else 2 * value
        doubled = _solve(problem | {"kernel": kernel}, solver, prescribed, load)
        _require_same_pressure(doubled, case, 2.0, solver, "of twice the stiffness")


def monitor_is_called(solver: Solver) -> None:
    """monitor(iteration, residual / tolerance) is called, the last time with the result's."""
    for problem in _problems():
        calls: list[tuple[int, float]] = []
        solution = solver.solve(problem, None, lambda *call, calls=calls: calls.append(call))
        require(bool(calls), "monitor is never called")
        iterations = [iteration for iteration, _ in calls]
        require(iterations == sorted(iterations), f"iterations {iterations}")
        what = f"monitor ends at iteration {iterations[-1]}, the result at {solution.iterations}"
        require(iterations[-1] == solution.iterations, what)
        require(calls[-1][1] <= 1, f"the last residual is {calls[-1][1]:g} of the tolerance")
