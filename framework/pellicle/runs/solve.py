"""Solve the load steps of a run one after the other."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Sequence
from dataclasses import replace
from functools import partial

import xarray as xr

from pellicle.components import Load, Monitor, Search, Setting
from pellicle.components.calls import target_of, traction_of
from pellicle.config.gradient import derivatives_of
from pellicle.config.provenance import provenance
from pellicle.config.run import Run
from pellicle.contact.equilibrium import Deformation
from pellicle.contact.load_step import FinishedStep, LoadStep, end_of
from pellicle.contact.problem import Traction
from pellicle.contact.solution import Stop
from pellicle.results.record import Steps, step_dataset

from .relaxation import Relaxation
from .target_search import search_target, solve_at
from .terms import AnyStep, ContactStep, Surroundings, Term
from .terms.adhesion import adhesion
from .terms.contact import contact
from .terms.gradient import Gradient
from .terms.relaxation import relaxation
from .terms.requested import corrections, prescription, stiffness
from .terms.surface import surface
from .terms.theory import theory


class Physics:
    """The physics of the load steps of a run besides their equilibrium, made once."""

    def __init__(self, run: Run, setting: Setting) -> None:
        self.history = Relaxation(run, setting.operator) if run.branches else None
        # Their measures are columns of a result in this order.
        named: dict[Callable[[Run, ContactStep, Surroundings], ContactStep], object] = {
            contact: True,
            corrections: run.corrections,
            prescription: True,
            stiffness: run.loading.stiffness,
            Gradient(run, setting).add: run.gradient,
            relaxation: self.history or run.loading.times,
            adhesion: run.interaction,
            theory: True,
        }
        self.terms: tuple[Term, ...] = tuple(partial(t, run) for t, has in named.items() if has)

    def measured(self, run: Run, setting: Setting, index: int, around: Surroundings) -> AnyStep:
        """Return a load step with the measures of all terms."""
        if run.load is not None:
            step = deform(run.load.at(index), setting)
            step = surface(run, run.load, step, around)
            return relaxation(run, step, around) if run.loading.times else step
        value = run.indentation.loading.values[index]
        solved = solve_step(run, setting, value, around.monitor)
        for term in self.terms:
            solved = term(solved, around)
        return solved


def solve_steps(
    run: Run, setting: Setting, steps: Steps, monitor_of: Callable[[int], Monitor]
) -> Generator[xr.Dataset, None, None]:
    """Solve the load steps missing from ``steps``; add and yield each as soon as it is solved."""
    origin, physics = provenance(run), Physics(run, setting)
    for index in range(len(steps), run.steps):
        # Without a name for the solved step, only its copy in ``steps`` outlives the solve.
        yield steps.append(
            _next_step(run, setting, steps.path, physics, monitor_of(index)).assign_attrs(origin)
        )


def _next_step(
    run: Run, base: Setting, path: Sequence[FinishedStep], physics: Physics, monitor: Monitor
) -> xr.Dataset:
    started = time.perf_counter()
    state = path[-1].state if path else None
    setting, applications = replace(base, state=state, path=end_of(path)), 0
    if history := physics.history:
        setting = history.setting(setting, path)
        applications = history.applications
    step = physics.measured(run, setting, len(path), Surroundings(setting, path, monitor))
    step = replace(step, applications=step.applications + applications)
    seconds = time.perf_counter() - started
    variables = [*run.variables, *derivatives_of(run)]
    return step_dataset(run.grid, len(path) + 1, step, variables, seconds)


def deform(load: Load, setting: Setting) -> AnyStep:
    """Return the load step under a known ``load``, by one application of the operator."""
    pressure, applied = traction_of(load, setting.grid), setting.operator.applications
    posed = Traction(setting.grid, setting.operator, pressure, setting.left)
    deformation = Deformation(posed, pressure)
    _ = deformation.displacement
    count = setting.operator.applications - applied
    return LoadStep(deformation, 0, Stop.DONE, applications=count)


def solve_step(run: Run, setting: Setting, value: float, monitor: Monitor) -> ContactStep:
    """Return the load step at a prescribed ``value``, started from the state of ``setting``."""
    applied = setting.operator.applications
    target = target_of(run.indentation.loading.prescription, setting, value)
    if isinstance(target, Search):
        step = search_target(setting, target, run.solver, monitor)
    else:
        step = solve_at(setting, target, run.solver, monitor)
    return replace(step, applications=setting.operator.applications - applied)
