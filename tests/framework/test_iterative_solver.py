"""The loop of an iteration ends when it is done, and not before it is plain that it will not be."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray

from pellicle import Grid, IterativeSolver, Problem, Stop
from pellicle.operators import make_operator
from pellicle_plugins.kernels.half_space import HalfSpace

Array = NDArray[np.float64]


class Played(IterativeSolver):
    """Goes through residuals that are given, with so many cells wrong at each."""

    type: Literal["played"] = "played"
    residuals: list[float]
    wrong: list[int]

    def begin(self, problem: Problem, start: Array | None) -> int:
        """Return the first place."""
        return 0

    def step(self, problem: Problem, state: int) -> int:
        """Return the next place."""
        return state + 1

    def residual(self, problem: Problem, state: int) -> float:
        """Return the residual at a place."""
        return self.residuals[state]

    def pressure(self, state: int) -> Array:
        """Return nothing."""
        return np.zeros((4, 4))

    def patience(self, problem: Problem) -> int:
        """Return three."""
        return 3


class PlayedByWrong(Played):
    """Counts fewer wrong cells as progress, too."""

    def merits(self, problem: Problem, state: int) -> tuple[float, ...]:
        """Return the number of wrong cells."""
        return (self.wrong[state],)


@pytest.mark.parametrize(
    ("solver", "residuals", "stop", "iterations"),
    [
        (Played, [1.0, 2.0, 2.0, 2.0, 0.5, 0.0], Stop.STALLED, 3),
        (Played, [1.0, 2.0, 0.9, 1.0, 1.0, 0.0], Stop.DONE, 5),
        (PlayedByWrong, [1.0, 2.0, 2.0, 2.0, 2.0, 0.0], Stop.DONE, 5),
        (PlayedByWrong, [1.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 0.0], Stop.STALLED, 7),
        (PlayedByWrong, [1.0, np.nan], Stop.NOT_FINITE, 1),
    ],
)
def test_end(solver: type[Played], residuals: list[float], stop: Stop, iterations: int) -> None:
    """Three iterations without a new least of anything that counts end it."""
    grid = Grid(points=4, size=1.0, boundary="periodic")
    operator = make_operator(HalfSpace(reduced_modulus=1.0), grid)
    problem = Problem(grid, operator, np.zeros(grid.shape), "force", 1.0)
    told: list[int] = []
    played = solver(residuals=residuals, wrong=[9, 8, 7, 6, 5, 5, 5, 5, 0], tolerance=1e-8)
    found = played.solve(problem, None, lambda iteration, excess: told.append(iteration))
    assert found.stop is stop
    assert found.iterations == iterations
    assert told == list(range(iterations + 1))
