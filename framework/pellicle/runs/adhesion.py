"""Numbers of an adhesive step besides its solution: the error of its force, the greatest pull."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from pellicle.components import Force, Monitor, Setting, Solver
from pellicle.components.calls import solution_of
from pellicle.components.checked_law import law_of
from pellicle.config.run import Run
from pellicle.numerics.problem import Depth, Equilibrium, equilibrium_of
from pellicle.numerics.solution import Stop

# Width of the zone over that of the step, for the estimate of the error.
_WIDER: Final = 1.5
# Halvings of the interval of forces in which the contact is lost.
_HALVINGS: Final = 6


def force_error(run: Run, equilibrium: Equilibrium, monitor: Monitor) -> float | None:
    """Return the estimated error of a force [N]; None if the interaction has no limit.

    The step is solved again at its depth with a wider zone. The error of the limit is proportional
    to the width, so the change of the force is half of the error of a zone half as wide again. It
    is NaN if the contact is lost with the wider zone.
    """
    wider = run.interaction.wider(_WIDER) if run.interaction else None
    if wider is None:
        return None
    if not equilibrium.contact.any():
        return 0.0
    law = law_of(wider, run.kernel, run.grid)
    problem = replace(equilibrium.problem, law=law, control=Depth(equilibrium.depth))
    other = equilibrium_of(problem, solution_of(run.solver, problem, equilibrium.state, monitor))
    if not other.contact.any():
        return float("nan")
    return abs(other.force - equilibrium.force) / (_WIDER - 1)


def greatest_pull(
    setting: Setting, solver: Solver, force: float, monitor: Monitor
) -> tuple[float, float]:
    """Return two forces [N] between which the contact of the last state is lost.

    The first is carried, the second is not; ``force`` is one that is not. Both are equal if there
    is no contact that could carry one.
    """
    state = setting.state
    if state is None or not state.contact.any():
        return force, force
    carried, lost = float(state.pressure.sum()) * setting.grid.cell_area, force
    for _ in range(_HALVINGS):
        middle = 0.5 * (carried + lost)
        solution = solution_of(solver, setting.problem(Force(middle)), state, monitor)
        if solution.stop is Stop.PULLED_OFF:
            lost = middle
        else:
            carried = middle
    return carried, lost
