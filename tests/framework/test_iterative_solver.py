"""The loop of an iteration ends when it is done, and not before it is plain that it will not be."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest

import pellicle as pl
from pellicle import Grid, IterativeSolver, Problem, Solution, State, Stop
from pellicle.arrays import Array
from pellicle.contact.solution import Progress
from pellicle.surface import operator_of
from pellicle_plugins.kernels.half_spaces import HalfSpace


class Played(IterativeSolver):
    """Goes through given measures, of which the first is the residual; iterates are progress."""

    type: Literal["played"] = "played"
    measures: list[tuple[float, ...]]
    gives_up: bool = False
    """Whether it stalls after three iterates that bring no progress in any measure."""

    def begin(self, problem: Problem, start: State | None) -> Any:
        """Return the first iterate."""
        return 0, Progress().after(*self.measures[0])

    def step(self, problem: Problem, state: Any) -> Any:
        """Return the next iterate."""
        index, progress = state
        return index + 1, progress.after(*self.measures[index + 1])

    def residual(self, problem: Problem, state: Any) -> float:
        """Return the residual of an iterate."""
        index: int = state[0]
        return self.measures[index][0]

    def pressure(self, state: Any) -> Array:
        """Return no pressure."""
        return np.zeros((4, 4))

    def terminate(self, problem: Problem, state: Any) -> Stop | None:
        """Return whether it stalls; the loop asks for more by itself."""
        if self.gives_up and state[1].stagnant >= 3:
            return Stop.STALLED
        return super().terminate(problem, state)


def solve(residuals: list[float], **fields: Any) -> tuple[Solution, list[int]]:
    """Return the solution of a problem, and the iterations that the monitor was called with."""
    grid = Grid(points=4, size=1.0, boundary="periodic")
    operator = operator_of(HalfSpace(reduced_modulus=1.0), grid)
    problem = Problem(grid, operator, np.zeros(grid.shape), pl.Force(1.0))
    iterations: list[int] = []
    solver = Played(**{"measures": [(r,) for r in residuals], "tolerance": 1e-8} | fields)
    solution = solver.solve(problem, None, lambda iteration, ratio: iterations.append(iteration))
    return solution, iterations


MISCLASSIFIED = [9, 8, 7, 6, 5, 5, 5, 5, 0]


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
    pairs = zip(residuals, MISCLASSIFIED, strict=False)
    more = {"measures": [*pairs]} if counts else {}
    solution, monitored = solve(residuals, gives_up=True, **more)
    assert (solution.stop, solution.iterations) == (stop, iterations)
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
    solution, _ = solve(residuals)
    assert (solution.stop, solution.iterations) == (stop, iterations)


@pytest.mark.parametrize("limit", [1, 5])
def test_limit(limit: int) -> None:
    """No more iterations than allowed, and one that ends it is not lost."""
    stop = Stop.DONE if limit == 5 else Stop.ITERATION_LIMIT
    solution, _ = solve([1.0] * 5 + [0.0], max_iterations=limit)
    assert (solution.stop, solution.iterations) == (stop, limit)
