"""Loops that end when they are done, or when it is plain that they will not be."""

from collections.abc import Callable
from typing import Any, ClassVar, Literal

import numpy as np
import pytest

import pellicle as pl
from pellicle import Grid, IterativeSolver, Solution, Stop
from pellicle.arrays import Array
from pellicle.components import Solver
from pellicle.contact import Problem
from pellicle.contact.solution import Progress, State
from pellicle.runs.solve import solve_at
from pellicle.runs.terms import ContactStep
from pellicle.surface import operator_of
from pellicle_plugins.kernels.half_spaces import HalfSpace

GRID = pl.Grid(points=11, size=11.0, boundary="periodic")


class Staircase(Solver):
    """Puts as many cells in contact as a function of the control says."""

    cells: Any
    starts: ClassVar[list[Any]] = []

    def solve(self, problem: Problem, start: Any, monitor: Any) -> pl.Solution:
        self.starts.append(start)
        pressure = np.zeros(problem.grid.points)
        pressure.ravel()[: self.cells(problem.control.value)] = 1.0
        return pl.Solution(State.of_pressure(pressure), 2)


def setting(start: float | None = None) -> pl.Setting:
    """Return that of a paraboloid on springs, after a step with a force on four cells."""
    x, y = GRID.coordinates()
    kernel = pl.kernel("winkler", foundation=1.0)
    profile = np.asarray(-(x**2 + y**2))
    state = None
    if start is not None:
        before = np.zeros(GRID.shape)
        before.ravel()[:4] = start / 4
        state = State(before, before, 1.0)
    return pl.Setting(GRID, operator_of(kernel, GRID), profile, "unbounded", state)


def search(cells: Callable[[float], int], area: float, start: float | None = None) -> ContactStep:
    """Return what is reached on a staircase of areas."""
    here = setting(start)
    target = pl.registry().find("prescription", "contact_area")().target(here, area)  # type: ignore[attr-defined]
    Staircase.starts.clear()
    return solve_at(here, target, Staircase(cells=cells), lambda *_: None)


@pytest.mark.parametrize("start", [None, 1e-6, 1.0, 1e6])
@pytest.mark.parametrize("power", [0.4, 1.0])
def test_whole_cells_are_met(power: float, start: float | None) -> None:
    """Where each number of cells can be had, the number is met from wherever it starts."""

    def cells(force: float) -> int:
        return int(min(max(round(40 * force**power), 1), 100))

    for area in (0.5, 3.0, 40.4, 99.6):
        reached = search(cells, area, start)
        # One cell is twice half a cell, and nothing is nearer.
        assert [c.values["end"] for c in reached.caveats] == ["nothing nearer"] * (area == 0.5)
        count = cells(reached.equilibrium.problem.control.value)
        assert abs(count - area) <= 0.5
        assert reached.missed == pytest.approx(abs(count - area) / area)
        assert reached.iterations % 2 == 0


@pytest.mark.parametrize(("area", "side"), [(32.0, 30), (37.0, 40)])
def test_jump_is_found(area: float, side: int) -> None:
    """Where the area jumps across what is wanted, the force is the jump's, on the nearer side."""
    jump = 7.3
    reached = search(lambda force: 30 if force < jump else 40, area)
    assert reached.equilibrium.problem.control.value == pytest.approx(jump, rel=2e-4)
    assert np.count_nonzero(reached.equilibrium.pressure) == side
    assert reached.missed == pytest.approx(abs(side - area) / area)
    values = reached.caveats[0].values
    assert (values["end"], values["below"], values["above"]) == ("jump", 30.0, 40.0)


@pytest.mark.parametrize("area", [20.0, 60.0])
def test_area_that_no_force_brings(area: float) -> None:
    """The search ends, and says that it found nothing."""
    reached = search(lambda force: 30, area)
    assert reached.caveats[0].values["end"] == "not found"
    assert reached.missed == pytest.approx(abs(30 - area) / area)


def test_every_trial_starts_from_the_step_before() -> None:
    """A trial that lost contact, or has too much of it, is the start of no other."""
    search(lambda force: 30 if force < 7.3 else 40, 37.0, 1.0)
    starts = Staircase.starts
    assert len(starts) > 5
    assert all(start.pressure.sum() == pytest.approx(1.0) for start in starts)


@pytest.mark.parametrize(("goal", "resolution"), [(-30.0, 1e-6), (0.0, 1e-6), (55.5, 0.0)])
@pytest.mark.parametrize("guess", [None, -20.0, 3.0])
@pytest.mark.parametrize("slope", [4.0, -4.0])
def test_any_quantity_by_depth(
    goal: float, resolution: float, guess: float | None, slope: float
) -> None:
    """A quantity of either sign, rising or falling, is found at the depth that has it.

    Before first touch too, and with no resolution, which it cannot meet exactly.
    """
    target = pl.Search(
        goal,
        lambda step: slope * step.problem.control.value - 2.0,
        control=pl.Depth,
        increasing=slope > 0,
        resolution=resolution,
        guess=guess,
    )
    reached = solve_at(setting(), target, Staircase(cells=lambda depth: 5), lambda *_: None)
    assert not reached.caveats
    assert reached.equilibrium.problem.control.value == pytest.approx((goal + 2) / slope, abs=1e-6)


def test_quantity_that_is_lost_is_not_found() -> None:
    """A pressure that is not finite ends in a status, not in an error."""

    class Lost(Solver):
        """Divides by zero."""

        def solve(self, problem: Problem, start: Any, monitor: Any) -> pl.Solution:
            return pl.Solution(State.of_pressure(np.full(problem.grid.shape, np.nan)), 1)

    run = pl.Run(
        grid={"points": 8, "size": 1e-3, "boundary": "periodic"},
        kernel={"type": "half_space", "reduced_modulus": 1e4},
        indenter={"type": "paraboloid", "radius": 1e-3},
        loading={"contact_area": 1e-7},
        solver=Lost(),
    )
    with pytest.warns(pl.ConvergenceWarning, match="NaN"):
        result = pl.run(run, progress=False)
    assert result.dataset["status_code"].item() == "NOT_FINITE"


def test_a_value_that_no_longer_grows_is_not_sought_for_ever() -> None:
    """Under 1e6 times the force still as many cells: the step is one of a moderate force."""
    step = search(lambda force: min(9, 1 + int(4 * force)), 20.0)
    assert not step.converged
    assert len(Staircase.starts) < 15
    assert step.equilibrium.force < 1e6
    assert step.missed == pytest.approx(11 / 20)


class Played(IterativeSolver):
    """Goes through given measures, of which the first is the residual; iterates are progress."""

    type: Literal["played"] = "played"
    measures: list[tuple[float, ...]]
    gives_up: bool = False
    """Whether it stalls after three iterates that bring no progress in any measure."""

    def begin(self, problem: Problem, start: State | None) -> Any:
        return 0, Progress().after(*self.measures[0])

    def step(self, problem: Problem, state: Any) -> Any:
        index, progress = state
        return index + 1, progress.after(*self.measures[index + 1])

    def residual(self, problem: Problem, state: Any) -> float:
        index: int = state[0]
        return self.measures[index][0]

    def pressure(self, state: Any) -> Array:
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
