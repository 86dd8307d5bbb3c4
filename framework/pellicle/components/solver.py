"""The contract of solvers."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import replace
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from pellicle.arrays import Array
from pellicle.contact.equilibrium import round_off
from pellicle.contact.problem import Adhesive, Problem
from pellicle.contact.solution import Progress, Solution, State, Stop
from pellicle.grid import Grid
from pellicle.plugins.component import Component
from pellicle.units import Quantity

Monitor = Callable[[int, float], None]
"""Function that a solver calls with its iteration and its residual over the tolerance."""

# A stagnating residual up to this multiple of the rounding of one application counts as rounding.
_ROUNDINGS = 30.0
# Peak memory of active_set in full contact, measured on Linux with glibc; on a periodic grid with
# half an array for figures that the collector has not freed yet.
_ARRAYS = {"free": 11.5, "periodic": 9.25}


class Solver(Component):
    """Finds the pressure of one load step."""

    family: ClassVar[str] = "solver"
    place: ClassVar[str] = "solver"

    tolerance: Annotated[
        float,
        Quantity("1", at_least=1e-13, below=1),
        Field(description="bound on every residual, relative to the indenter's height range"),
    ] = 1e-8

    def refuses(self, problem: Problem) -> str:
        """Return why it cannot solve a problem; empty if it can.

        The default refuses a law that acts across the gap.
        """
        sticks = isinstance(problem, Adhesive)
        return "cannot solve with an interaction; use active_set" if sticks else ""

    def arrays(self, grid: Grid) -> float:
        """Return the number of arrays of the grid's shape that a solve needs at its peak.

        Arrays of eight bytes per cell, in addition to operator and indenter; by default those of
        active_set in full contact.
        """
        return _ARRAYS[grid.boundary]

    @abstractmethod
    def solve(self, problem: Problem, start: State | None, monitor: Monitor) -> Solution:
        """Return the solution of one load step.

        ``start`` is where the iteration may start: the state at the end of the last step or
        what the last two lead to; None at the first step. The framework computes the residuals of
        the solution itself; the solver's own estimates are not used.
        """

    def response(self, problem: Problem, state: State, monitor: Monitor) -> Array:
        """Return dp/dδ [Pa/m] of the grid's shape, with the contact of ``state`` fixed.

        This is the pressure per depth under a flat punch with the contact as its footprint: it
        displaces the contact by 1, to `tolerance`, may have either sign there and is 0 elsewhere.
        It does not depend on the profile and the load of ``problem``. Its sum times the area of a
        cell is the contact stiffness. With a law the traction off the contact follows the gap with
        the slope of the law; a solver that takes laws has to include it. The default uses conjugate
        gradients (`scipy.sparse.linalg.cg`); a solver with a preconditioner overrides it.
        """
        from scipy.sparse.linalg import LinearOperator, cg

        # The stiffness of the contact does not include that of a spring that holds the indenter.
        operator = problem.operator.with_spring(0.0)
        cells = np.flatnonzero(state.contact)
        pressure = np.zeros(problem.grid.shape)
        iteration = 0

        def displacement(on_contact: Array) -> Array:
            pressure.ravel()[cells] = on_contact
            return operator(pressure).ravel()[cells]

        def count(_: Array) -> None:
            nonlocal iteration
            iteration += 1
            monitor(iteration, 1.0)

        matrix = LinearOperator((cells.size, cells.size), matvec=displacement, dtype=np.float64)
        on_contact, _ = cg(matrix, np.ones(cells.size), rtol=self.tolerance / 2, callback=count)
        pressure.ravel()[cells] = on_contact
        return pressure


class IterativeSolver(Solver):
    """A solver defined by a first iterate, a step and a residual; the loop is common to all."""

    max_iterations: Annotated[
        int,
        Field(
            gt=0,
            title="iteration limit",
            description="iterations after which a step is abandoned and marked",
        ),
    ] = 20_000

    @abstractmethod
    def begin(self, problem: Problem, start: State | None) -> Any:
        """Return the first iterate; ``start`` is as in `solve`."""

    @abstractmethod
    def step(self, problem: Problem, state: Any) -> Any:
        """Return the next iterate, which may reuse the memory of ``state``."""

    @abstractmethod
    def residual(self, problem: Problem, state: Any) -> float:
        """Return the largest residual of an iterate, relative as `tolerance` is."""

    @abstractmethod
    def pressure(self, state: Any) -> Array:
        """Return the pressure [Pa] of an iterate."""

    def state(self, state: Any) -> State:
        """Return the solution's state of an iterate; by default that of its pressure."""
        return State.of_pressure(self.pressure(state))

    def terminate(self, problem: Problem, state: Any) -> Stop | None:
        """Return the reason to end the iteration above the tolerance; None, the default, continues.

        `Stop.STALLED` becomes `Stop.ROUND_OFF` if the residual is not more than rounding. The loop
        also ends when the residual has not reached a new minimum for N + 200 iterations, N being
        the sum of the grid's edges in cells: gradient methods need O(N) iterations, and their
        residual does not fall monotonically.
        """
        return None

    def solve(self, problem: Problem, start: State | None, monitor: Monitor) -> Solution:
        """Iterate until the tolerance is met or `terminate` or another limit ends the iteration."""
        state = self.begin(problem, start)
        iteration, progress = 0, Progress()
        while True:
            residual = self.residual(problem, state)
            monitor(iteration, residual / self.tolerance)
            progress = progress.after(residual)
            stop: Stop | None
            if not np.isfinite(residual):
                stop = Stop.NOT_FINITE
            elif residual <= self.tolerance:
                stop = Stop.DONE
            elif progress.stagnant >= sum(problem.grid.shape) + 200:
                stop = Stop.STALLED
            else:
                stop = self.terminate(problem, state)
            if stop is None and iteration >= self.max_iterations:
                stop = Stop.ITERATION_LIMIT
            if stop is not None:
                break
            state = self.step(problem, state)
            iteration += 1
        solution = Solution(self.state(state), iteration, stop)
        if stop is Stop.STALLED and residual <= _ROUNDINGS * round_off(problem, solution.pressure):
            solution = replace(solution, stop=Stop.ROUND_OFF)
        return solution
