"""The contract of solvers."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from operator import lt
from typing import (
    Annotated,
    Any,
    ClassVar,
    Protocol,
    runtime_checkable,
)

import numpy as np
from pydantic import Field

from pellicle.arrays import Array, Mask
from pellicle.grid import Grid
from pellicle.numerics.problem import Problem, round_off
from pellicle.numerics.solution import Solution, Stop
from pellicle.units import Quantity

from .base import Component

Monitor = Callable[[int, float], None]
"""Called by a solver with its iteration and its residual over the tolerance, to show progress."""


# Residuals of an iteration that has gone as far as rounding lets it, over that of an application.
_ROUNDINGS = 30.0


@runtime_checkable
class HasMemory(Protocol):
    """A solver that states its memory; the estimate before a run uses it."""

    def arrays(self, grid: Grid) -> float:
        """Return the number of arrays of the grid's shape that a solve holds at its peak.

        Arrays of eight bytes a cell, beside operator and indenter.
        """
        ...


class Solver(Component):
    """Finds the pressure of one load step."""

    family: ClassVar[str] = "solver"

    tolerance: Annotated[
        float,
        Quantity("1", at_least=1e-13, below=1),
        Field(description="bound on every residual, relative to the indenter's height range"),
    ] = 1e-8

    @abstractmethod
    def solve(self, problem: Problem, start: Array | None, monitor: Monitor) -> Solution:
        """Return the pressure that solves ``problem``.

        ``start`` is the pressure [Pa] of the step before, or None. The framework measures the
        result afresh; what a solver believes of its accuracy is not used.
        """

    def punch_pressure(self, problem: Problem, contact: Mask, monitor: Monitor) -> Array:
        """Return the pressure per depth [Pa/m] under a flat punch whose footprint is ``contact``.

        It displaces the surface there by 1, to `tolerance`, and is of either sign; elsewhere it is
        0. What else ``problem`` says of indenter and load does not matter. The framework makes the
        contact stiffness of it. Here by conjugate gradients (`scipy.sparse.linalg.cg`); a solver
        that has a preconditioner overrides this.
        """
        from scipy.sparse.linalg import LinearOperator, cg

        cells = np.flatnonzero(contact)
        whole = np.zeros(problem.grid.shape)
        done = 0

        def displaced(pressure: Array) -> Array:
            whole.ravel()[cells] = pressure
            return problem.operator(whole).ravel()[cells]

        def tell(_: Array) -> None:
            nonlocal done
            done += 1
            monitor(done, 1.0)

        operator = LinearOperator((cells.size, cells.size), matvec=displaced, dtype=np.float64)
        found, _ = cg(operator, np.ones(cells.size), rtol=self.tolerance / 2, callback=tell)
        whole.ravel()[cells] = found
        return whole


class IterativeSolver(Solver):
    """A solver that is a start, a step and a residual; one loop does the rest."""

    max_iterations: Annotated[
        int,
        Field(gt=0, description="iterations after which a step is given up, and says so"),
    ] = 20_000

    @abstractmethod
    def begin(self, problem: Problem, start: Array | None) -> Any:
        """Return the first state."""

    @abstractmethod
    def step(self, problem: Problem, state: Any) -> Any:
        """Return the next state; it may reuse the memory of ``state``."""

    @abstractmethod
    def residual(self, problem: Problem, state: Any) -> float:
        """Return the largest residual of a state, relative as `tolerance` is."""

    @abstractmethod
    def pressure(self, state: Any) -> Array:
        """Return the pressure [Pa] of a state."""

    def patience(self, problem: Problem) -> int:
        """Return how many iterations end it if none brings a new least residual or merit.

        A multiple of N here: a gradient method needs O(N) iterations, some of them in vain.
        """
        return sum(problem.grid.shape) + 200

    def merits(self, problem: Problem, state: Any) -> tuple[float, ...]:
        """Return what else than the residual falls while the iteration gets on: here nothing."""
        return ()

    def solve(self, problem: Problem, start: Array | None, monitor: Monitor) -> Solution:
        """Iterate until the tolerance is met, or it is plain that it will not be."""
        state = self.begin(problem, start)
        patience = self.patience(problem)
        best: tuple[float, ...] = ()
        best_at = iteration = 0
        while True:
            residual = self.residual(problem, state)
            monitor(iteration, residual / self.tolerance)
            merits = (residual, *self.merits(problem, state))
            if any(map(lt, merits, best)):
                best_at = iteration
            best = tuple(map(min, merits, best or merits))
            if not np.isfinite(residual):
                stop = Stop.NOT_FINITE
            elif residual <= self.tolerance:
                stop = Stop.DONE
            elif iteration - best_at >= patience:
                at_rounding = residual <= _ROUNDINGS * round_off(problem, self.pressure(state))
                stop = Stop.ROUND_OFF if at_rounding else Stop.STALLED
            elif iteration >= self.max_iterations:
                stop = Stop.ITERATION_LIMIT
            else:
                state = self.step(problem, state)
                iteration += 1
                continue
            return Solution(self.pressure(state), iteration, stop)
