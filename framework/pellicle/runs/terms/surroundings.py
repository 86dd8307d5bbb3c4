"""What a term knows besides the load step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from pellicle.arrays import Array
from pellicle.components import Monitor, Setting, Solver
from pellicle.components.solver import response_of, solution_of
from pellicle.contact.equilibrium import Equilibrium, equilibrium_of
from pellicle.contact.finished_step import FinishedStep
from pellicle.contact.load_step import LoadStep
from pellicle.contact.problem import Problem
from pellicle.contact.solution import Solution, State


class Solve(NamedTuple):
    """The solver of a run, for terms that solve again."""

    solver: Solver
    monitor: Monitor

    def __call__(self, problem: Problem, start: State | None) -> tuple[Solution, Equilibrium]:
        """Return the solution of a problem from a start, and its equilibrium."""
        solution = solution_of(self.solver, problem, start, self.monitor)
        return solution, equilibrium_of(problem, solution)

    def response(self, problem: Problem, state: State) -> Array:
        """Return dp/dδ [Pa/m] with the contact of ``state`` fixed."""
        return response_of(self.solver, problem, state, self.monitor)


class Surroundings(NamedTuple):
    """Where a load step was solved."""

    setting: Setting
    """That of the run, with what the steps before have left behind."""
    path: Sequence[FinishedStep]
    """The steps before."""
    solve: Solve


Term = Callable[[LoadStep, Surroundings], LoadStep]
"""Returns the step with measures and caveats of its own added; the run is bound beforehand."""
