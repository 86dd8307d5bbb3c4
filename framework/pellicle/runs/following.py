"""Solve a load step from the states before it, without leaving the path of an adhesive contact."""

from __future__ import annotations

from dataclasses import replace

from pellicle.components import Monitor, Setting, Solver
from pellicle.components.calls import solution_of
from pellicle.contact.equilibrium import Equilibrium, equilibrium_of
from pellicle.contact.problem import Problem
from pellicle.contact.solution import Solution, Stop

from .jumps import leaves_path


def followed(
    setting: Setting, solver: Solver, problem: Problem, monitor: Monitor
) -> tuple[Solution, Equilibrium]:
    """Return the solution of a problem that starts from the last steps of ``setting``.

    With a law there may be several equilibria, and the path leads to the one that is reached from
    the last state. So if the solution from an extrapolated start did not converge, or lies across
    a jump, the problem is solved again from the last state alone.
    """
    solution = solution_of(solver, problem, setting.start(problem), monitor)
    equilibrium = equilibrium_of(problem, solution)
    if not solution.extrapolated:
        return solution, equilibrium
    done = solution.stop is Stop.DONE and not solution.jumped
    if done and not leaves_path(setting.path, equilibrium, solver.tolerance):
        return solution, equilibrium
    again = solution_of(solver, problem, setting.state, monitor)
    again = replace(again, iterations=solution.iterations + again.iterations)
    return again, equilibrium_of(problem, again)
