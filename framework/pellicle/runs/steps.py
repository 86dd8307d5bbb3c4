"""Solve the load steps of a run one after the other."""

from __future__ import annotations

import time
from collections.abc import Generator
from dataclasses import replace

import numpy as np
import xarray as xr

from pellicle.arrays import Mask
from pellicle.components import Depth, Monitor, Search, Setting
from pellicle.components.base import words_of_type
from pellicle.components.calls import (
    branches_of,
    corrected_area,
    report_of,
    response_of,
    target_of,
)
from pellicle.config.provenance import provenance
from pellicle.config.run import Run
from pellicle.contact.caveats import sentence_of, status_of, to_text
from pellicle.contact.equilibrium import Equilibrium
from pellicle.contact.solution import Stop
from pellicle.contact.stiffness import Stiffness, measure_stiffness
from pellicle.results.step import Steps, step_dataset
from pellicle.variables import Variable, corrected_fraction
from pellicle.variables import corrected_area as area_variable

from .adhesion import asperity_jumped, force_limit, greatest_pull, jump_energy
from .following import followed
from .progress import Bar
from .relaxation import Relaxation
from .target_search import Reached, reach
from .verdict import judge


def solve_steps(
    run: Run, setting: Setting, steps: Steps, bar: Bar
) -> Generator[xr.Dataset, None, None]:
    """Solve the load steps missing from ``steps``; add and yield each as soon as it is solved."""
    origin = provenance(run)
    solid = Relaxation(run) if branches_of(run.kernel) else None
    for index in range(len(steps), len(run.loading.values)):
        of_step, applications = replace(setting, state=steps.state, path=steps.path), 0
        if solid:
            of_step = solid.setting(of_step, steps.field("pressure"), steps.field("displacement"))
            applications = solid.applications
        # Without a name for the solved step, only its copy in ``steps`` outlives the solve.
        yield steps.append(
            _solved_step(run, of_step, steps, bar.step(index), applications).assign_attrs(origin)
        )


def _solved_step(
    run: Run, setting: Setting, steps: Steps, monitor: Monitor, applications: int
) -> xr.Dataset:
    """Return the load step after ``steps``, solved and judged.

    ``applications`` is the number of operator applications that ``setting`` took.
    """
    index = len(steps)
    started = time.perf_counter()
    applied = setting.operator.applications
    value, prescription = run.loading.values[index], run.loading.prescription
    step = solve_step(run, setting, value, monitor)
    used = setting.operator.applications - applied + applications
    limit = force_limit(run, step.equilibrium, monitor)
    stiffness = _stiffness(run, step.equilibrium, monitor) if run.loading.stiffness else None
    lost = jump_energy(setting.path, step.equilibrium, run.solver.tolerance) if setting.law else 0.0
    jumped = step.jumped or lost > 0 or asperity_jumped(setting.state, step.equilibrium)
    in_part = jumped and not step.jumped and bool(step.equilibrium.contact.any())
    area = np.count_nonzero(step.equilibrium.contact) * run.grid.cell_area
    largest_area = max(area, steps.largest_area)
    caveats = judge(run, index, step, stiffness, lost if in_part else None, largest_area)
    report = report_of(prescription, setting, step.equilibrium)
    report |= {v.name: step.missed for v in prescription.variables if v.name not in report}
    areas = _corrected_areas(run, step.equilibrium.contact)
    scalars = {
        **{variable.name: value for variable, value in areas.items()},
        **report,
        **({"stiffness": stiffness.value} if stiffness else {}),
        **({"time": run.loading.times[index]} if run.loading.times else {}),
        **({"cycle": run.loading.samples[index].cycle} if run.loading.oscillates else {}),
        **({"jumped": jumped, "jump_energy": lost} if setting.law else {}),
        **({"force_extrapolated": limit[0], "force_error": limit[1]} if limit else {}),
        "iterations": step.iterations,
        "operator_applications": used,
        "converged": status_of(caveats).converged,
        "status_code": status_of(caveats).name,
        "status": sentence_of(caveats),
        "caveats": to_text(caveats),
        "wall_time": time.perf_counter() - started,
    }
    added = (*areas, *prescription.variables)
    solved = step_dataset(run.grid, index + 1, step.equilibrium, scalars, added)
    if setting.law and branches_of(run.kernel) and run.loading.durations[index] > 0:
        # The energy of a solid that has relaxed on its way does not follow from its surface.
        solved["energy"][:] = np.nan
    return solved


def solve_step(run: Run, setting: Setting, value: float, monitor: Monitor) -> Reached:
    """Return the load step at a prescribed ``value``, started from the state of ``setting``."""
    target = target_of(run.loading.prescription, setting, value)
    if isinstance(target, Search):
        return reach(setting, target, run.solver, monitor)
    problem = setting.problem(target)
    solution, equilibrium = followed(setting, run.solver, problem, monitor)
    step = Reached(equilibrium, solution.iterations, solution.stop, jumped=solution.jumped)
    if step.stop is Stop.PULLED_OFF:
        pull = greatest_pull(setting, run.solver, problem.control.value, monitor)
        step = step._replace(between=pull)
    return step


def _corrected_areas(run: Run, contact: Mask) -> dict[Variable, float]:
    """Return the contact area by each correction, and after these the shares of the domain."""
    areas = {
        area_variable(
            correction.type_name, words_of_type(type(correction), correction.type_name)
        ): corrected_area(correction, contact, run.grid)
        for correction in run.corrections
    }
    return areas | {corrected_fraction(v): area / run.grid.area for v, area in areas.items()}


def _stiffness(run: Run, equilibrium: Equilibrium, monitor: Monitor) -> Stiffness:
    """Return the contact stiffness dF/dδ, δ being the depth of the indenter."""
    problem = replace(equilibrium.problem, control=Depth(equilibrium.depth))
    contact = equilibrium.contact
    if problem.has_infinite_stiffness(contact):
        return Stiffness(np.inf, 0.0)
    if not contact.any():
        return Stiffness(0.0, 0.0)
    response = response_of(run.solver, problem, equilibrium.state, monitor)
    return measure_stiffness(problem, contact, response, equilibrium.attraction)
