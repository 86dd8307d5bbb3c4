"""Solve the load steps of a run one after the other."""

from __future__ import annotations

import time
from collections.abc import Generator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from pellicle.components import Monitor
from pellicle.components.calls import (
    corrected_area,
    response_of,
    solution_of,
)
from pellicle.config.provenance import provenance
from pellicle.config.run import Run
from pellicle.numerics.problem import Equilibrium, Problem, Stiffness, measure, measure_stiffness
from pellicle.numerics.solution import Solution, State
from pellicle.results.step import Steps, step_dataset
from pellicle.results.variables import corrected_area as area_variable

from .progress import Bar
from .target_search import Reached, reach_area

if TYPE_CHECKING:
    import xarray as xr
from .compose import prescribed_areas
from .verdict import judge


def solve_steps(
    run: Run, problems: Sequence[Problem], steps: Steps, bar: Bar
) -> Generator[xr.Dataset, None, None]:
    """Add each load step that ``steps`` lack as soon as it is solved, and yield it."""
    origin = provenance(run)
    first = len(steps)
    for index, problem in enumerate(problems[first:], first):
        # Only the copy in ``steps`` outlives a solve; the next one starts from its state.
        yield steps.append(
            _solved_step(run, index, problem, steps.state, bar.step(index)).assign_attrs(origin)
        )


def _solved_step(
    run: Run, index: int, problem: Problem, start: State | None, monitor: Monitor
) -> xr.Dataset:
    """Return a load step, solved and judged."""
    started = time.perf_counter()
    applied = problem.operator.applications
    step = solve_step(run, index, problem, start, monitor)
    used = problem.operator.applications - applied
    found = measure(step.problem, step.solution.pressure)
    stiffness = _stiffness(run, problem, found, monitor)
    status, message = judge(run, index, found, step, stiffness)
    scalars = {
        **_asked(run, problem, found, step, stiffness),
        "iterations": step.solution.iterations,
        "operator_applications": used,
        "converged": status.converged,
        "status_code": status.name,
        "status": message,
        "wall_time": time.perf_counter() - started,
    }
    areas = [area_variable(correction.type_name) for correction in run.corrections]
    return step_dataset(run.grid, index + 1, found, scalars, areas)


def solve_step(
    run: Run, index: int, problem: Problem, start: State | None, monitor: Monitor
) -> Reached:
    """Return the solution of load step ``index``, started from ``start``."""
    areas = prescribed_areas(run)
    if areas and areas[index] > 0:
        return reach_area(problem, areas[index], run.solver, start, monitor)
    if not problem.touches:
        return Reached(problem, Solution(np.zeros(run.grid.shape), 0), 0.0, "met")
    solution = solution_of(run.solver, problem, start, monitor)
    return Reached(problem, solution, 0.0, "met")


def _stiffness(
    run: Run, problem: Problem, found: Equilibrium, monitor: Monitor
) -> Stiffness | None:
    """Return the contact stiffness if it is asked for."""
    if not run.loading.stiffness:
        return None
    contact = found.contact
    if problem.is_rigid(contact):
        return Stiffness(np.inf, 0.0)
    if not contact.any():
        return Stiffness(0.0, 0.0)
    state = State(found.pressure, found.pressure, found.depth)
    return measure_stiffness(problem, contact, response_of(run.solver, problem, state, monitor))


def _asked(
    run: Run, problem: Problem, found: Equilibrium, step: Reached, stiffness: Stiffness | None
) -> dict[str, float]:
    """Return the numbers that are there because the run asks for them."""
    loading = {
        "mean_plane_depth": found.depth + float(problem.profile.mean()),
        "residual_area": step.missed,
        "stiffness": stiffness.value if stiffness else np.nan,
    }
    corrected = {
        area_variable(correction.type_name).name: corrected_area(
            correction, found.contact, run.grid
        )
        for correction in run.corrections
    }
    return corrected | {name: loading[name] for name in loading if name in run.loading.brings}
