"""Solvers that break their contract at work are refused by name, before a result is wrong."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import numpy as np
import pytest

import pellicle as pl
from pellicle.problem import Problem
from tests.framework.broken_contracts.short_run import base, run

ConjugateGradient: Any = base("solver", "conjugate_gradient")


class Solver(ConjugateGradient):
    """Conjugate gradients that break their contract."""

    type: Literal["liar"] = "liar"

    def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
        """Return the solution, changed."""
        return self.change(super().solve(problem, start, monitor), problem, start)

    def change(self, solution: Any, problem: Any, start: Any) -> Any:
        """Return something else."""
        return solution


class NoSolution(Solver):
    """Forgets to return."""

    def change(self, solution: Any, problem: Any, start: Any) -> Any:
        """Return None."""


class BarePressure(Solver):
    """Returns the pressure alone."""

    def change(self, solution: Any, problem: Any, start: Any) -> Any:
        """Return an array."""
        return solution.pressure


class Transposed(Solver):
    """Returns a pressure of the wrong shape."""

    def change(self, solution: Any, problem: Any, start: Any) -> Any:
        """Return the transpose."""
        return replace(solution, state=solution.pressure.T)


class ComplexPressure(Solver):
    """Returns a complex pressure."""

    def change(self, solution: Any, problem: Any, start: Any) -> Any:
        """Return an imaginary part."""
        return replace(solution, state=solution.pressure + 1j)


class PressureAsText(Solver):
    """Returns text as its pressure."""

    def change(self, solution: Any, problem: Any, start: Any) -> Any:
        """Return text."""
        return replace(solution, state="10 Pa")


class NoStop(Solver):
    """Does not say why it stopped."""

    def change(self, solution: Any, problem: Any, start: Any) -> Any:
        """Return a solution without a reason."""
        return replace(solution, stop=None)


class OtherOperator(Solver):
    """Puts another operator into its problem."""

    def change(self, solution: Any, problem: Any, start: Any) -> Any:
        """Set the operator behind the back of the dataclass."""
        object.__setattr__(problem, "operator", None)
        return solution


class AssignsOperator(Solver):
    """Assigns another operator to its problem."""

    def change(self, solution: Any, problem: Any, start: Any) -> Any:
        """Set the operator."""
        problem.operator = None
        return solution


class SofterOperator(Solver):
    """Makes the operator twice as soft in place, and solves that."""

    def change(self, solution: Any, problem: Any, start: Any) -> Any:
        """Scale the symbol."""
        problem.operator._symbol["D"][...] *= 2
        return solution


class OtherSymbol(Solver):
    """Gives the operator another symbol."""

    def change(self, solution: Any, problem: Any, start: Any) -> Any:
        """Replace the symbol."""
        problem.operator._symbol.double = 2 * problem.operator._symbol["D"]
        return solution


class OtherKernel(Solver):
    """Gives the operator another kernel."""

    def change(self, solution: Any, problem: Any, start: Any) -> Any:
        """Replace the kernel."""
        problem.operator.kernel = None
        return solution


class LowersProfile(Solver):
    """Lowers the indenter."""

    def change(self, solution: Any, problem: Any, start: Any) -> Any:
        """Write to the profile."""
        problem.profile[...] -= 1e-6
        return solution


class WorksInStart(Solver):
    """Returns the array that it is given to start from, with new values."""

    def change(self, solution: Any, problem: Any, start: Any) -> Any:
        """Write to the start."""
        if start is not None:
            start.pressure[...] = solution.pressure
            return replace(solution, state=start)
        return solution


SOLVERS = {
    NoSolution: ["solve() returned None", "pellicle.Solution"],
    BarePressure: ["solve() returned array(", "pellicle.Solution"],
    Transposed: ["solve().pressure returned an array of float64 of shape (10, 12)", "(12, 10)"],
    ComplexPressure: ["solve().pressure returned an array of complex128"],
    PressureAsText: ["solve().pressure returned '10 Pa'"],
    NoStop: ["stop None", "pellicle.Stop"],
    OtherOperator: ["solve() changes problem.operator", "leave its problem as it is"],
    AssignsOperator: ["changes what it is given", "operator"],
    SofterOperator: ["changes what it is given", "read-only"],
    OtherSymbol: ["solve() changes problem.operator.symbol"],
    OtherKernel: ["solve() changes problem.operator.kernel"],
    LowersProfile: ["changes what it is given", "read-only"],
    WorksInStart: ["changes what it is given", "read-only"],
}


@pytest.mark.parametrize(
    "loading", [{"depth": ["2 um", "4 um"]}, {"contact_radius": ["60 um", "70 um"]}]
)
@pytest.mark.parametrize("lie", SOLVERS)
def test_a_solver_that_lies_is_refused(lie: Any, loading: dict[str, Any]) -> None:
    """No number of a result comes from a problem that the solver changed, or from no pressure."""
    with pytest.raises(pl.PluginError) as error:
        run(solver=lie(tolerance=1e-6), loading=loading)
    for part in ["solver 'liar'", *SOLVERS[lie]]:
        assert part in str(error.value)


def test_applications_cannot_be_set() -> None:
    """The count of operator applications in a result is the operator's own."""

    class Modest(Solver):
        """Sets the count back."""

        def change(self, solution: Any, problem: Any, start: Any) -> Any:
            """Set the count."""
            problem.operator.applications = 0

    with pytest.raises(AttributeError, match="applications") as error:
        run(solver=Modest(tolerance=1e-6))
    assert error.value.__notes__[0].startswith("solver 'liar' failed")


def test_a_solver_that_uses_its_memory_again_changes_no_earlier_step() -> None:
    """Each step keeps its own pressure, though the solver returns one array for all."""
    memory = np.zeros((12, 10))

    class Thrifty(Solver):
        """Returns the same array each time."""

        def change(self, solution: Any, problem: Any, start: Any) -> Any:
            """Write into one array."""
            memory[...] = solution.pressure
            return replace(solution, state=memory)

    thrifty = run(solver=Thrifty(tolerance=1e-6)).dataset
    plain = run(solver=Solver(tolerance=1e-6)).dataset
    np.testing.assert_array_equal(thrifty["pressure"], plain["pressure"])


class WideResponse(Solver):
    """Presses off the contact."""

    def response(self, problem: Problem, state: Any, monitor: Any) -> Any:
        """Return a pressure everywhere."""
        return super().response(problem, state, monitor) + 1.0


class NoResponse(Solver):
    """Has no pressure under a punch."""

    def response(self, problem: Problem, state: Any, monitor: Any) -> Any:
        """Return None."""


class FillsContact(Solver):
    """Makes the footprint larger."""

    def response(self, problem: Problem, state: Any, monitor: Any) -> Any:
        """Write to the contact."""
        state.pressure[...] = 1.0
        return super().response(problem, state, monitor)


RESPONSES = {
    WideResponse: "response() returned a pressure off the contact",
    NoResponse: "response() returned None",
    FillsContact: "changes what it is given",
}


@pytest.mark.parametrize("lie", RESPONSES)
def test_a_response_that_lies_is_refused(lie: Any) -> None:
    """The contact stiffness of a result is not made of a pressure that is none."""
    with pytest.raises(pl.PluginError, match="solver 'liar'") as error:
        run(solver=lie(tolerance=1e-6), loading={"depth": "4 um", "stiffness": True})
    assert RESPONSES[lie] in str(error.value)
