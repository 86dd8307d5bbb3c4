"""Calls of a solver: the solution of a load step and its stiffness."""

from __future__ import annotations

from dataclasses import replace
from numbers import Integral

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import (
    component_name,
    errors_attributed_to,
    read_only,
    real_array,
    real_number,
)
from pellicle.components.solver import Monitor, Solver
from pellicle.contact.problem import Problem
from pellicle.contact.solution import Solution, State, Stop
from pellicle.errors import ConfigError, PluginError, shown


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
    adheres = problem.law is not None
    sticks = adheres and start is not None and start.is_loaded
    if not problem.needs_solving and not sticks:
        nothing = np.zeros(problem.grid.shape)
        lost = adheres and problem.prescribed == "force"
        stop = Stop.PULLED_OFF if lost else Stop.DONE
        return Solution(State(nothing, nothing, problem.depth(np.zeros(1))), 0, stop)
    view = replace(problem, profile=read_only(problem.profile))
    with errors_attributed_to(solver):
        value = solver.solve(view, None if start is None else _read_only_state(start), monitor)
    state = _checked_state(solver, problem, value)
    jumped = bool(value.jumped) or (adheres and _in_contact(state) != _in_contact(start))
    return Solution(state, int(value.iterations), value.stop, jumped)


def _checked_state(solver: Solver, problem: Problem, value: object) -> State:
    """Return a copy of the state of a solution; without a law its pressure is all that counts."""
    name = component_name(solver)
    if not isinstance(value, Solution):
        raise PluginError(
            f"{name}: solve() returned {shown(value)}; it has to return a pellicle.Solution"
        )
    if not isinstance(value.state, State):
        raise PluginError(
            f"{name}: solve() returned a Solution of {shown(value.state)}; it has to be one of a "
            "pellicle.State: State.of_pressure(pressure), or with an interaction one that has the "
            "wall pressure too"
        )
    pressure = real_array(solver, "solve().pressure", value.pressure, problem.grid.shape)
    if not isinstance(value.iterations, Integral) or not isinstance(value.stop, Stop):
        raise PluginError(
            f"{name}: solve() returned iterations {shown(value.iterations)} and stop "
            f"{shown(value.stop)}; they have to be a whole number and a pellicle.Stop"
        )
    # The solver may reuse the memory of the arrays that it returned.
    pressure = pressure.copy()
    if problem.law is None:
        return State.of_pressure(pressure)
    wall = real_array(solver, "solve().state.wall", value.state.wall, problem.grid.shape)
    depth = real_number(solver, "solve().state.depth", value.state.depth)
    return State(pressure, wall.copy(), depth)


def _in_contact(state: State | None) -> bool:
    return state is not None and bool(state.contact.any())


def response_of(solver: Solver, problem: Problem, state: State, monitor: Monitor) -> Array:
    """Return dp/dδ [Pa/m] with the contact of ``state`` fixed."""
    view = replace(problem, profile=read_only(problem.profile))
    with errors_attributed_to(solver):
        value = solver.response(view, _read_only_state(state), monitor)
    pressure = real_array(solver, "response()", value, problem.grid.shape)
    if problem.law is None and pressure[~state.contact].any():
        raise PluginError(
            f"{component_name(solver)}: response() returned a pressure off the contact; it has to "
            "be 0 there"
        )
    return pressure


def _read_only_state(state: State) -> State:
    pressure = read_only(state.pressure)
    wall = pressure if state.wall is state.pressure else read_only(state.wall)
    return State(pressure, wall, state.depth)
