"""Solve the load steps of a run one after the other."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Sequence
from dataclasses import replace
from functools import partial
from math import isfinite

import xarray as xr

from pellicle.components import Depth, Force, Monitor, Prescription, Search, Setting, Solver
from pellicle.components.calls import solution_of, target_of
from pellicle.config.gradient import derivatives_of
from pellicle.config.provenance import provenance
from pellicle.config.run import Run
from pellicle.contact.equilibrium import Deformation, equilibrium_of
from pellicle.contact.load_step import LoadStep, end_of, start_of
from pellicle.contact.moved_front import is_on_path
from pellicle.contact.problem import Traction
from pellicle.contact.solution import Stop
from pellicle.grid import Grid
from pellicle.results.record import Steps, step_dataset
from pellicle.variables import Variable

from .relaxation import Relaxation
from .target_search import search_target
from .terms import AnyStep, AroundContact, ContactStep, Step, Surroundings, Term
from .terms.adhesion import adhesion
from .terms.contact import contact
from .terms.extra_measures import corrections, prescription, stiffness
from .terms.gradient import Gradient
from .terms.layer import layer
from .terms.relaxation import relaxation
from .terms.surface import surface


def solve_steps(
    run: Run,
    composed: Setting | Sequence[Traction],
    steps: Steps,
    monitor_of: Callable[[int], Monitor],
) -> Generator[xr.Dataset, None, None]:
    """Solve the load steps missing from ``steps``; add and yield each as soon as it is solved.

    ``composed`` is what `compose` returns of the run.
    """
    origin, variables = provenance(run), run.variables
    if run.gradient:
        # Those by heights are fields.
        variables += derivatives_of(run)
    operator = (composed if isinstance(composed, Setting) else composed[0]).operator
    history = Relaxation(run, operator) if run.branches else None
    if isinstance(composed, Setting):
        solve = _contacts(run, composed, history)
    else:
        solve = _loads(run, composed, history)
    for index in range(len(steps), run.steps):
        around = Surroundings(steps.path, monitor_of(index))
        # Without a name for the solved step, only its copy in ``steps`` outlives the solve.
        yield steps.append(_record(run.grid, solve, around, variables).assign_attrs(origin))


def _record(
    grid: Grid,
    solve: Callable[[Surroundings], AnyStep],
    around: Surroundings,
    variables: Sequence[Variable],
) -> xr.Dataset:
    started = time.perf_counter()
    step = solve(around)
    seconds = time.perf_counter() - started
    return step_dataset(grid, len(around.path) + 1, step, variables, seconds)


def _contacts(
    run: Run, setting: Setting, history: Relaxation | None
) -> Callable[[Surroundings], AnyStep]:
    """Return a function that solves the step of a contact after those of a path."""
    loading, terms = run.indentation.loading, terms_of(run, setting)

    def solve(around: Surroundings) -> AnyStep:
        path = around.path
        here = replace(setting, state=path[-1].state if path else None, path=end_of(path))
        here = history.setting(here, path) if history else here
        value = loading.values[len(path)]
        step = solve_step(here, loading.prescription, value, run.solver, around.monitor)
        for term in terms:
            step = term(run, step, AroundContact(path, around.monitor, here))
        return _with_effort(step, history)

    return solve


def _loads(
    run: Run, posed: Sequence[Traction], history: Relaxation | None
) -> Callable[[Surroundings], AnyStep]:
    """Return a function that deforms the surface in the step of a load after those of a path."""

    def solve(around: Surroundings) -> AnyStep:
        here = posed[len(around.path)]
        here = history.setting(here, around.path) if history else here
        applied, deformation = here.operator.applications, Deformation(here, here.pressure)
        step: AnyStep = LoadStep(deformation, 0, Stop.DONE)
        for term in (surface, layer, relaxation):
            step = term(run, step, around)
        step = replace(step, applications=here.operator.applications - applied)
        return _with_effort(step, history)

    return solve


def _with_effort(step: Step, history: Relaxation | None) -> Step:
    """Return the step with the applications that brought its history forward."""
    if not history:
        return step
    return replace(step, applications=step.applications + history.applications)


def terms_of(run: Run, setting: Setting) -> list[Term]:
    """Return the terms of a contact; their measures are columns of a result in this order."""
    prescribed = run.indentation.loading.prescription
    reports = prescribed.variables or type(prescribed).report is not Prescription.report
    terms: list[Term] = [contact]
    terms += [corrections] * bool(run.corrections)
    terms += [prescription] * bool(reports)
    terms += [stiffness] * run.loading.stiffness
    terms += [Gradient(run, setting).add] if run.gradient else []
    terms += [relaxation] * bool(run.branches or run.loading.times)
    terms += [adhesion] * bool(run.interaction)
    terms += [layer] * isfinite(run.kernel.depth_to_base())
    return terms


def solve_step(
    setting: Setting, prescription: Prescription, value: float, solver: Solver, monitor: Monitor
) -> ContactStep:
    """Return the load step at a prescribed ``value``, started from the state of ``setting``."""
    applied = setting.operator.applications
    target = target_of(prescription, setting, value)
    step = solve_at(setting, target, solver, monitor)
    return replace(step, applications=setting.operator.applications - applied)


def solve_at(
    setting: Setting, target: Depth | Force | Search, solver: Solver, monitor: Monitor
) -> ContactStep:
    """Return the load step at a depth, at a force, or where a search ends."""
    if isinstance(target, Search):
        solve = partial(solve_at, setting, solver=solver, monitor=monitor)
        return search_target(setting, target, solve, solver.tolerance)
    problem = setting.problem(target)
    start = start_of(problem, setting.state, setting.path)
    solution = solution_of(solver, problem, start, monitor)
    if setting.sticks and start is not setting.state and not is_on_path(solution, problem.grid):
        first = solution.iterations
        solution = solution_of(solver, problem, setting.state, monitor)
        solution = replace(solution, iterations=first + solution.iterations)
    equilibrium = equilibrium_of(problem, solution)
    return LoadStep(equilibrium, solution.iterations, solution.stop, solution.jumped)
