"""For each rule of solvers: a solver that breaks it, and only it, by a little."""

from dataclasses import replace
from typing import Any, Literal

import pytest

import pellicle as pl
from tests.framework.testing.mutants import base, check_base, check_mutant, rules_of

ConjugateGradient: Any = base("solver", "conjugate_gradient")


class Solver(ConjugateGradient):
    """Conjugate gradients to be broken."""

    type: Literal["broken"] = "broken"


class Sucking(Solver):
    """Leaves a negative pressure in one cell."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        solution = super().solve(problem, start, monitor)
        pressure = solution.pressure.copy()
        pressure[0, 0] = -1e-9 * pressure.max()
        return replace(solution, state=pressure)


class Lying(Solver):
    """Says that it is done when it is not."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        solution = super().solve(problem, start, monitor)
        return replace(solution, state=1.0001 * solution.pressure)


class GivingUp(Solver):
    """Stops early, and says so."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        return super().model_copy(update={"max_iterations": 3}).loop(problem, start, monitor)

    def loop(self, problem: Any, start: Any, monitor: Any) -> Any:
        return ConjugateGradient.solve(self, problem, start, monitor)


class Overwritten(Solver):
    """Works in the array that it is given to start from."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        solution = super().solve(problem, start, monitor)
        if start is not None:
            start.pressure[...] = solution.pressure
        return solution


class Shared(Solver):
    """Returns the array that it is given to start from, if that is right."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        solution = super().solve(problem, start, monitor)
        if start is None:
            return solution
        return replace(solution, state=start, stop=pl.Stop.STALLED)


class Stale(Solver):
    """Takes the step before for the answer."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        solution = super().solve(problem, start, monitor)
        if start is None:
            return solution
        return replace(solution, state=start.pressure.copy(), stop=pl.Stop.STALLED)


class Absolute(Solver):
    """Knows of soft solids only."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        solution = super().solve(problem, start, monitor)
        soft = problem.operator.kernel.reduced_modulus < 1.5e4
        stop = pl.Stop.STALLED
        return solution if soft else replace(solution, state=0.9 * solution.pressure, stop=stop)


class Silent(Solver):
    """Tells nobody how far it is."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        return super().solve(problem, start, lambda *progress: None)


class Miscounting(Solver):
    """Returns another number of iterations than it told."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        solution = super().solve(problem, start, monitor)
        return replace(solution, iterations=solution.iterations + 1)


class Round(Solver):
    """Takes every punch for a round one."""

    def response(self, problem: Any, state: Any, monitor: Any) -> Any:
        return 1.01 * super().response(problem, state, monitor)


class Wide(Solver):
    """Presses off the contact."""

    def response(self, problem: Any, state: Any, monitor: Any) -> Any:
        return super().response(problem, state, monitor) + 1e-3


class Working(Solver):
    """Applies the operator to know its residual."""

    def residual(self, problem: Any, state: Any) -> Any:
        problem.operator(state.pressure)
        return super().residual(problem, state)


class Wearing(Solver):
    """Shrinks its error a little with each look."""

    def residual(self, problem: Any, state: Any) -> Any:
        residual = super().residual(problem, state)
        object.__setattr__(state, "scale", (1 + 1e-9) * state.scale)
        return residual


class Mute(Solver):
    """Returns nothing."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        super().solve(problem, start, monitor)


class Rowwise(Solver):
    """Returns the pressure in a row."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        solution = super().solve(problem, start, monitor)
        return replace(solution, state=solution.pressure.ravel())


class OutOfPhase(Solver):
    """Returns a complex pressure."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        solution = super().solve(problem, start, monitor)
        return replace(solution, state=solution.pressure + 0j)


class Meddling(Solver):
    """Puts an operator of its own into the problem."""

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        solution = super().solve(problem, start, monitor)
        object.__setattr__(problem, "operator", None)
        return solution


SOLVERS = {
    Mute: "solve_returns_a_solution",
    Rowwise: "solve_returns_a_solution",
    OutOfPhase: "solve_returns_a_solution",
    Meddling: "solve_returns_a_solution",
    Sucking: "pressure_is_nowhere_negative",
    Lying: "done_means_solved",
    GivingUp: "prescribed_values_are_met",
    Overwritten: "start_belongs_to_the_caller",
    Shared: "start_belongs_to_the_caller",
    Stale: "start_does_not_matter",
    Absolute: "pressure_is_proportional_to_the_stiffness",
    Working: "residual_has_no_side_effect",
    Wearing: "residual_has_no_side_effect",
    Silent: "monitor_is_called",
    Miscounting: "monitor_is_called",
    Round: "response_is_that_of_a_flat_punch",
    Wide: "response_is_that_of_a_flat_punch",
}


@pytest.mark.parametrize(
    ("mutant", "rule"), SOLVERS.items(), ids=lambda value: getattr(value, "__name__", "")
)
def test_mutant_is_caught(mutant: Any, rule: str) -> None:
    """The message names the class, the rule, what is asked and what was found."""
    check_mutant("solver", mutant(tolerance=1e-6), rule)


def test_what_the_mutants_are_made_of_is_whole() -> None:
    """Without its fault each mutant breaks nothing but that no plugin registers it."""
    check_base("solver", Solver(tolerance=1e-6))


def test_each_rule_has_a_mutant(monkeypatch: pytest.MonkeyPatch) -> None:
    """No rule could be dropped, or say yes to everything, without a test that fails."""
    assert rules_of("solver", monkeypatch) == set(SOLVERS.values())
