"""The loop of an iteration ends when it is done, and not before it is plain that it will not be."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
import pytest

import pellicle as pl
from pellicle import Grid, IterativeSolver, Problem, Solution, Solver, State, Stop
from pellicle.arrays import Array
from pellicle.contact.solution import Progress
from pellicle.surface import make_operator
from pellicle_plugins.kernels.half_spaces import HalfSpace


class Iterate(NamedTuple):
    """An index into what is played, and the progress up to there."""

    place: int
    progress: Progress


class Played(IterativeSolver):
    """Goes through given residuals, and gives up after three that bring no progress."""

    type: Literal["played"] = "played"
    residuals: list[float]
    misclassified: list[int]
    counts: bool = False

    def begin(self, problem: Problem, start: State | None) -> Iterate:
        """Return the first iterate."""
        return Iterate(0, Progress().after(*self.measures(0)))

    def step(self, problem: Problem, state: Iterate) -> Iterate:
        """Return the next iterate."""
        index = state.place + 1
        return Iterate(index, state.progress.after(*self.measures(index)))

    def measures(self, index: int) -> Sequence[float]:
        """Return the residual, and the misclassified cells if they count as progress."""
        return self.residuals[index], *self.misclassified[index : index + self.counts]

    def residual(self, problem: Problem, state: Iterate) -> float:
        """Return the residual of an iterate."""
        return self.residuals[state.place]

    def pressure(self, state: Iterate) -> Array:
        """Return no pressure."""
        return np.zeros((4, 4))

    def terminate(self, problem: Problem, state: Iterate) -> Stop | None:
        """Return whether it stalls."""
        return Stop.STALLED if state.progress.stagnant >= 3 else None


class Endless(Played):
    """Never gives up by itself."""

    def terminate(self, problem: Problem, state: Iterate) -> Stop | None:
        """Leave it to the loop."""
        return IterativeSolver.terminate(self, problem, state)


def solve(solver: Solver) -> tuple[Solution, list[int]]:
    """Return the solution of a problem, and the iterations that the monitor was called with."""
    grid = Grid(points=4, size=1.0, boundary="periodic")
    operator = make_operator(HalfSpace(reduced_modulus=1.0), grid)
    problem = Problem(grid, operator, np.zeros(grid.shape), pl.Force(1.0))
    iterations: list[int] = []
    solution = solver.solve(problem, None, lambda iteration, ratio: iterations.append(iteration))
    return solution, iterations


@pytest.mark.parametrize(
    ("counts", "residuals", "stop", "iterations"),
    [
        (False, [1.0, 2.0, 2.0, 2.0, 0.5, 0.0], Stop.STALLED, 3),
        (False, [1.0, 2.0, 0.9, 1.0, 1.0, 0.0], Stop.DONE, 5),
        (True, [1.0, 2.0, 2.0, 2.0, 2.0, 0.0], Stop.DONE, 5),
        (True, [1.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 0.0], Stop.STALLED, 7),
        (True, [1.0, np.nan], Stop.NOT_FINITE, 1),
    ],
)
def test_end(counts: bool, residuals: list[float], stop: Stop, iterations: int) -> None:
    """Three iterations without a new least of anything that counts end it."""
    solution, monitored = solve(
        Played(
            residuals=residuals,
            misclassified=[9, 8, 7, 6, 5, 5, 5, 5, 0],
            counts=counts,
            tolerance=1e-8,
        )
    )
    assert solution.stop is stop
    assert solution.iterations == iterations
    assert monitored == list(range(iterations + 1))


@pytest.mark.parametrize(
    ("residuals", "stop", "iterations"),
    [
        ([1.0] * 300, Stop.STALLED, 208),
        ([1.0] * 200 + [0.9] * 300, Stop.STALLED, 408),
        ([1.0] * 200 + [0.9] * 200 + [0.0], Stop.DONE, 400),
    ],
)
def test_end_by_default(residuals: list[float], stop: Stop, iterations: int) -> None:
    """The sum of the grid's edges and 200 more iterations without a new least residual end it."""
    solution, _ = solve(Endless(residuals=residuals, misclassified=[], tolerance=1e-8))
    assert (solution.stop, solution.iterations) == (stop, iterations)


@pytest.mark.parametrize("limit", [1, 5])
def test_limit(limit: int) -> None:
    """No more iterations than allowed, and one that ends it is not lost."""
    residuals = [1.0] * 5 + [0.0]
    solver = Endless(residuals=residuals, misclassified=[], max_iterations=limit, tolerance=1e-8)
    stop = Stop.DONE if limit == 5 else Stop.ITERATION_LIMIT
    solution, _ = solve(solver)
    assert (solution.stop, solution.iterations) == (stop, limit)
