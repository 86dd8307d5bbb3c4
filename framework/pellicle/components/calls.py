"""Guarded calls of components: what they are given is read-only, what they return is checked."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from numbers import Integral
from typing import get_args

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.checks import component_name, errors_attributed_to, read_only, real_array, real_number
from pellicle.contact.equilibrium import Equilibrium
from pellicle.contact.problem import Adhesive, Depth, Force, Problem
from pellicle.contact.solution import Solution, State, Stop
from pellicle.errors import ConfigError, PluginError, excerpt, problems_within
from pellicle.grid import Grid, grid_of_run
from pellicle.units import DIGITS, readable

from .correction import AreaCorrection
from .indenter import Footprint, Indenter
from .lattice import Lattice
from .load import Load
from .prescription import Prescription, Search, Setting
from .solver import Monitor, Solver

# Rounding error of heights over the size of the domain, and of areas.
_ROUNDING = 1e-12


def profile_of(indenter: Indenter, grid: Grid) -> Array:
    """Return the profile f ≤ 0 [m] of an indenter on a grid, read-only."""
    x, y = map(read_only, grid.coordinates())
    lattice = Lattice(grid) if grid.boundary == "periodic" else None
    with problems_within("indenter"), errors_attributed_to(indenter), grid_of_run(grid):
        value, footprint = indenter.repeated(x, y, lattice), indenter.footprint
    profile = real_array(indenter, "profile(x, y)", value, grid.shape)
    if footprint not in get_args(Footprint):
        raise PluginError(
            f"{component_name(indenter)}: footprint is {excerpt(footprint)}; it has to be "
            "'unbounded' or 'domain'"
        )
    if np.isneginf(profile).all():
        cells, domain = (
            " × ".join(readable(edge, "m", DIGITS) for edge in edges)
            for edges in (grid.spacing, grid.size)
        )
        raise ConfigError(
            f"cells of {cells} are wider than {component_name(indenter)}, which lies over no cell "
            f"centre; use a smaller grid.size, which is {domain}, or more points",
            "indenter",
        )
    if not (profile <= 0).all():
        raise ConfigError(
            f"the profile of {component_name(indenter)} has values that are positive or NaN; it "
            "must be ≤ 0 everywhere and 0 at the lowest point",
            "indenter",
        )
    highest = float(profile.max())
    rounding = _ROUNDING * max(grid.size)
    if highest < -rounding and highest < -(hidden := _hidden_height(profile, footprint)):
        raise PluginError(
            f"{component_name(indenter)}: the highest value of profile(x, y) is {highest:.3g} m, "
            f"further below 0 than the {hidden:.3g} m by which neighbouring cells differ; it has "
            "to be 0 at the lowest point"
        )
    return read_only(np.ascontiguousarray(profile))


def _hidden_height(profile: Array, footprint: Footprint) -> float:
    """Return an upper bound [m] on the height of the lowest cell above the lowest point.

    If the apex of a smooth body lies between the cells, the lowest cell is closer to it in height
    than to the highest of its neighbours. The apex of a rough surface may be elsewhere, so the
    largest step between any two neighbours is the bound. The apex of an unbounded body may also lie
    beyond the edge of the domain.
    """
    if footprint == "domain":
        with np.errstate(invalid="ignore"):
            steps = [np.abs(np.diff(profile, axis=axis)) for axis in (0, 1)]
        return max(
            float(np.nan_to_num(step, nan=0.0, posinf=np.inf).max(initial=0)) for step in steps
        )
    top = float(profile.max())
    i, j = np.nonzero(profile[1:-1, 1:-1] == top)
    if not i.size:
        return np.inf
    lowest_around = np.min([profile[i + a, j + b] for a in range(3) for b in range(3)], axis=0)
    return top - float(lowest_around.max())


def traction_of(load: Load, grid: Grid) -> Array:
    """Return the traction [Pa] of a load of one step on a grid, read-only."""
    x, y = map(read_only, grid.coordinates())
    with problems_within("load"), errors_attributed_to(load), grid_of_run(grid):
        value = load.traction(x, y)
    traction = real_array(load, "traction(x, y)", value, grid.shape)
    if not np.isfinite(traction).all():
        raise PluginError(
            f"{component_name(load)}: traction(x, y) has values that are NaN or infinite; it has "
            "to be finite on every cell"
        )
    return read_only(np.ascontiguousarray(traction))


def check_values(
    prescription: Prescription,
    setting: Setting,
    values: Iterable[float],
    field_of: Callable[[int], str] = "{}".format,
) -> None:
    """Let a prescription check the values of load steps, whose fields ``field_of`` names.

    An error that names a field already keeps that one.
    """
    with errors_attributed_to(prescription):
        for index, value in enumerate(values):
            try:
                prescription.check(setting, value)
            except ConfigError as error:
                named = any(problem.field for problem in error.problems)
                raise (error if named else error.within(field_of(index))) from None


def target_of(prescription: Prescription, setting: Setting, value: float) -> Depth | Force | Search:
    """Return the depth, the force or the search for a prescribed value."""
    with errors_attributed_to(prescription):
        target = prescription.target(setting, value)
    call = f"target(setting, {value:g})"
    if not isinstance(target, (Depth, Force, Search)):
        raise PluginError(
            f"{component_name(prescription)}: {call} returned {excerpt(target)}; it has to return "
            "a pellicle.Depth, Force or Search"
        )
    for field in ("value", "compliance", "goal", "resolution", "width", "guess"):
        number = getattr(target, field, None)
        if number is None:
            continue
        number = real_number(prescription, f"{call}.{field}", number)
        signed = field in ("goal", "guess") or (
            field == "value" and (isinstance(target, Depth) or setting.law is not None)
        )
        if not np.isfinite(number) or (number < 0 and not signed):
            allowed = "finite" if signed else "finite and ≥ 0"
            raise PluginError(
                f"{component_name(prescription)}: {call}.{field} is {number:g}; it has to be "
                f"{allowed}"
            )
    if not isinstance(target, Search):
        return target
    quantity = target.measure
    if target.control not in (Depth, Force) or not callable(quantity):
        raise PluginError(
            f"{component_name(prescription)}: {call} has to search by control = Depth or Force, "
            "with a function as measure"
        )

    def measure(step: Equilibrium) -> float:
        with errors_attributed_to(prescription):
            return real_number(prescription, f"{call}.measure(step)", quantity(step))

    return replace(target, measure=measure)


def report_of(prescription: Prescription, setting: Setting, step: Equilibrium) -> dict[str, float]:
    """Return the variables that a prescription adds to a step."""
    with errors_attributed_to(prescription):
        report = prescription.report(setting, step)
    declared = {v.name for v in prescription.variables if v.kind != "residual"}
    if not isinstance(report, dict) or report.keys() != declared:
        raise PluginError(
            f"{component_name(prescription)}: report() returned {excerpt(report)}; it has to "
            f"return a dict of {', '.join(sorted(declared)) or 'nothing'}, as its variables declare"
        )
    return {
        name: real_number(prescription, f"report()[{name!r}]", value)
        for name, value in report.items()
    }


def check_solver(solver: Solver, problem: Problem) -> None:
    """Let a solver refuse a problem."""
    with errors_attributed_to(solver):
        reason = solver.refuses(problem)
    if reason:
        raise ConfigError(f"{component_name(solver)} {reason}", "solver.type")


def solution_of(
    solver: Solver, problem: Problem, start: State | None, monitor: Monitor
) -> Solution:
    """Return the solution of a load step, with a copy of its pressure.

    A negative or non-finite pressure is accepted here; the status of the step reports it.
    """
    check_solver(solver, problem)
    adheres = isinstance(problem, Adhesive)
    sticks = adheres and start is not None and start.is_loaded
    if not problem.needs_solving and not sticks:
        nothing = np.zeros(problem.grid.shape)
        lost = adheres and problem.prescribed == "force"
        stop = Stop.PULLED_OFF if lost else Stop.DONE
        return Solution(State(nothing, nothing, problem.depth(np.zeros(0))), 0, stop)
    view = replace(problem, profile=read_only(problem.profile))
    with errors_attributed_to(solver):
        value = solver.solve(view, None if start is None else _read_only_state(start), monitor)
    state = _checked_state(solver, problem, value)
    jumped = bool(value.jumped)
    # Under a law with a range contact may begin and end smoothly.
    if isinstance(problem, Adhesive) and (start is None or problem.law.needs_contact):
        touched = start is not None and bool(start.contact.any())
        jumped = jumped or bool(state.contact.any()) != touched
    return Solution(state, int(value.iterations), value.stop, jumped)


def _checked_state(solver: Solver, problem: Problem, value: object) -> State:
    """Return a copy of the state of a solution; without a law its pressure is all that counts."""
    if not isinstance(value, Solution):
        raise PluginError(
            f"{component_name(solver)}: solve() returned {excerpt(value)}; it has to return a "
            "pellicle.Solution"
        )
    for member, kind in {"state": State, "iterations": Integral, "stop": Stop}.items():
        if not isinstance(part := getattr(value, member), kind):
            raise PluginError(
                f"{component_name(solver)}: solve() returned a Solution of {member} {excerpt(part)}"
                "; it needs a pellicle.State, such as State.of_pressure(pressure), a whole "
                "number of iterations and a pellicle.Stop"
            )
    # The solver may reuse the memory of the arrays that it returned.
    pressure = real_array(solver, "solve().pressure", value.pressure, problem.grid.shape).copy()
    if not isinstance(problem, Adhesive):
        return State.of_pressure(pressure)
    wall = real_array(solver, "solve().state.wall", value.state.wall, problem.grid.shape)
    depth = real_number(solver, "solve().state.depth", value.state.depth)
    return State(pressure, wall.copy(), depth)


def response_of(solver: Solver, problem: Problem, state: State, monitor: Monitor) -> Array:
    """Return dp/dδ [Pa/m] with the contact of ``state`` fixed."""
    view = replace(problem, profile=read_only(problem.profile))
    with errors_attributed_to(solver):
        value = solver.response(view, _read_only_state(state), monitor)
    pressure = real_array(solver, "response()", value, problem.grid.shape)
    if not isinstance(problem, Adhesive) and pressure[~state.contact].any():
        raise PluginError(
            f"{component_name(solver)}: response() returned a pressure off the contact; it has to "
            "be 0 there"
        )
    return pressure


def _read_only_state(state: State) -> State:
    pressure = read_only(state.pressure)
    wall = pressure if state.wall is state.pressure else read_only(state.wall)
    return State(pressure, wall, state.depth)


def corrected_area(correction: AreaCorrection, contact: Mask, grid: Grid) -> float:
    """Return the corrected area of contact [m²]."""
    call = "area(contact, spacing, boundary)"
    with errors_attributed_to(correction):
        value = correction.area(read_only(contact), grid.spacing, grid.boundary)
    area = real_number(correction, call, value)
    largest = grid.area if contact.any() else 0.0
    if not 0 <= area <= largest * (1 + _ROUNDING):
        raise PluginError(
            f"{component_name(correction)}: {call} returned {area:g} m²; it has to be between 0 "
            f"and {largest:g} m², {'the area of the domain' if largest else 'without contact'}"
        )
    return area
