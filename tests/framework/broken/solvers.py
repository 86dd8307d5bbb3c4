"""Solvers that break their contract."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

import pellicle as pl
from tests.framework.broken.catalogue import Broken, Family, Marked, Refused, Taken, base, run

Solver: Any = base("solver", "conjugate_gradient")


def _run(**loading: Any) -> Any:
    return lambda solver, _: run(solver=solver, loading=loading)


def returns(change: Callable[[Any], Any]) -> Any:
    """Return a method whose value is changed."""
    return lambda f, *given: change(f(*given))


def gives(fault: str, run: Refused | Marked | Taken, **changes: Callable[[Any], Any]) -> Broken:
    """Return a solver whose solution s has other members."""
    return Broken(
        fault, run, solve=returns(lambda s: replace(s, **{k: v(s) for k, v in changes.items()}))
    )


def harms(fault: str, run: Refused, action: Callable[[Any], Any]) -> Broken:
    """Return a solver that changes its problem when it has solved it."""
    return Broken(fault, run, solve=lambda f, problem, *_: (f(problem, *_), action(problem))[0])


def answers(fault: str, run: Refused | Marked, response: Any) -> Broken:
    """Return a solver with another response under a punch."""
    return Broken(fault, run, "stiffness", response=response)


def after(change: Callable[[Any, Any], Any]) -> Any:
    """Return a method whose solution is changed where there is a start."""

    def solve(f: Any, problem: Any, start: Any, monitor: Any) -> Any:
        solution = f(problem, start, monitor)
        return solution if start is None else change(solution, start)

    return solve


def overwritten(solution: Any, start: Any) -> Any:
    start.pressure[...] = solution.pressure
    return replace(solution, state=start)


def negative(solution: Any) -> Any:
    pressure = solution.pressure.copy()
    pressure[0, 0] = -1e-9 * pressure.max()
    return of(pressure)


def _modulus(problem: Any) -> float:
    """Return E* [Pa], which the longest waves feel alone."""
    q = np.array([1e-3])
    return float((2 / (q * problem.operator.symbol(q, 0 * q))).item())


def of_soft_solids(f: Any, problem: Any, *given: Any) -> Any:
    solution, soft = f(problem, *given), _modulus(problem) < 1.5e4
    return solution if soft else replace(solution, state=of(0.9 * solution.pressure), stop=STALLED)


def three_steps(f: Any, *given: Any) -> Any:
    solver = f.__self__.model_copy(update={"max_iterations": 3})
    return f.__func__(solver, *given)


def fill(f: Any, problem: Any, state: Any, monitor: Any) -> Any:
    state.pressure[...] = 1.0
    return f(problem, state, monitor)


of = pl.State.of_pressure
STALLED = pl.Stop.STALLED
READ_ONLY = Refused("read-only", error=ValueError)
NOT_SEEN = Taken("a run measures the residual without it, and counts nothing by it")
OFF = Marked("CONTACT_RESIDUAL")
BROKEN: dict[str, Any] = {
    "start_does_not_matter": [
        Broken("writes into its start", READ_ONLY, solve=after(overwritten)),
        Broken("echoes", OFF, solve=after(lambda s, start: replace(s, state=start, stop=STALLED))),
        Broken(
            "takes the step before for the answer",
            OFF,
            solve=after(lambda s, start: replace(s, state=of(start.pressure.copy()), stop=STALLED)),
        ),
    ],
    "prescribed_values_are_met": [
        Broken("returns nothing", Refused("solve() returned None"), solve=returns(lambda s: None)),
        gives(
            "in a row", Refused("shape (120,)", "(12, 10)"), state=lambda s: of(s.pressure.ravel())
        ),
        gives("a pressure", Refused("it needs a pellicle.State"), state=lambda s: s.pressure),
        gives("ends without reason", Refused("stop None", "pellicle.Stop"), stop=lambda s: None),
        harms("softens the operator", READ_ONLY, lambda p: p.operator._values.double.fill(1.0)),
        harms("lowers the profile", READ_ONLY, lambda problem: np.copyto(problem.profile, -1.0)),
        gives("sucks", Marked("NEGATIVE_PRESSURE"), state=negative),
        gives("is not done", OFF, state=lambda s: of(1.0001 * s.pressure)),
        Broken("gives up early", OFF, solve=three_steps),
    ],
    "pressure_is_proportional_to_the_stiffness": Broken(
        "knows of soft solids alone", Taken("this solid is soft"), solve=of_soft_solids
    ),
    "monitor_is_called": [
        Broken("tells nobody", NOT_SEEN, solve=lambda f, p, s, monitor: f(p, s, lambda *_: None)),
        gives("counts another number", NOT_SEEN, iterations=lambda s: s.iterations + 1),
    ],
    "response_is_that_of_a_flat_punch": [
        answers("response under another punch", Marked("STIFFNESS"), returns(lambda p: 1.01 * p)),
        answers("off the contact", Refused("a pressure off the"), returns(lambda p: p + 1e-3)),
        answers("no response", Refused("response() returned None"), returns(lambda p: None)),
        answers("response that fills the contact", READ_ONLY, fill),
    ],
}
SOLVERS = Family(
    Solver,
    {"tolerance": 1e-6},
    {"path": _run(depth=["1 um", "2 um"]), "stiffness": _run(depth="2 um", stiffness=True)},
    ("path",),
    BROKEN,
)
