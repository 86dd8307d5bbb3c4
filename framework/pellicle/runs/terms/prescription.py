"""What is prescribed: the report of its prescription, and how near a search came."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from pellicle.components.prescription import report_of
from pellicle.config.run import Run
from pellicle.contact.caveats import Caveat, Status
from pellicle.contact.load_step import LoadStep, SearchEnd

from .surroundings import Surroundings

# Relative distance from its goal above which a search has not converged.
_NEAR: Final = 0.05


def prescription(run: Run, step: LoadStep, surroundings: Surroundings) -> LoadStep:
    """Add the variables of the prescription, and whether its search ended away from the goal."""
    prescribed, search = run.loading.prescription, step.search
    report = report_of(prescribed, surroundings.setting, step.equilibrium)
    missed = search.missed if search else 0.0
    report |= {v.name: missed for v in prescribed.variables if v.name not in report}
    sticks = step.equilibrium.problem.law is not None
    return step.having(report, _not_met(search, sticks) if search else ())


def _not_met(search: SearchEnd, sticks: bool) -> Iterator[Caveat]:
    """Yield the caveat of a search that ended away from its goal."""
    is_near = search.missed <= _NEAR
    if search.how == "met" and is_near:
        return
    values: dict[str, float | str] = {"quantity": search.quantity, "measure": search.missed}
    if search.how == "nearest":
        values |= {"below": search.below, "above": search.above, "unit": search.unit}
    of_area = search.quantity == "contact area"
    if search.how == "nearest" and is_near:
        yield Caveat(Status.NEAREST_AREA if of_area else Status.NEAREST, values)
        return
    ends = {
        "met": "nothing nearer",
        "nearest": "jump with a law" if sticks else "jump",
        "not found": "not found",
    }
    values |= {"tolerance": _NEAR, "end": ends[search.how]}
    yield Caveat(Status.AREA if of_area else Status.NOT_REACHED, values)
