"""A load step from its solve to its copy in the result, and what it leaves to those after it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf, nan
from typing import Any, Final, Generic, Self, TypeVar

import numpy as np

from pellicle.arrays import Array

from .caveats import Caveat, rank_caveats
from .equilibrium import Deformation
from .moved_front import moved_on
from .problem import Adhesive, Depth, Unilateral
from .solution import State, Stop

# Longest step, over the last one, to which is extrapolated.
_FARTHEST: Final = 2.0
# Beside a smooth contact the gap grows with this power of the distance.
_GAP_POWER: Final = 1.5
# Pressure of cells that join, over the greatest.
_JOINING: Final = 1e-9

Value = float | bool | int
Surface = TypeVar("Surface", bound=Deformation, covariant=True)


@dataclass(frozen=True)
class LoadStep(Generic[Surface]):
    """A solved load step; after a search, the trial nearest to the goal.

    It holds the problem and some eight fields, so it must not outlive the copy into the result.
    """

    equilibrium: Surface
    iterations: int
    """Iterations of the solver, summed over all trials of a search."""
    stop: Stop
    jumped: bool = False
    """Whether all contact was gained or lost since the start."""
    missed: float = 0.0
    """|value − goal| / |goal| of a search."""
    applications: int = 0
    """Applications of the operator on the finest grid."""
    measures: Mapping[str, Value] = field(default_factory=dict)
    """Numbers besides those of the equilibrium, by the name of their variable."""
    fields: Mapping[str, Array] = field(default_factory=dict)
    """Fields besides those of the equilibrium, by the name of their variable."""
    response: tuple[Array, float] | None = None
    """dp/dδ [Pa/m] and dF/dδ [N/m] of the contact, once known; of an infinite one any multiple."""
    caveats: tuple[Caveat, ...] = ()
    """Caveats of the step, sorted by `rank_caveats`."""

    @property
    def converged(self) -> bool:
        """Whether the numbers of the step may be used, possibly with a caveat."""
        return all(caveat.status.converged for caveat in self.caveats)

    def with_measures(
        self,
        measures: Mapping[str, Value],
        caveats: Iterable[Caveat] = (),
        fields: Mapping[str, Array] | None = None,
    ) -> Self:
        """Return the step with more measures, caveats and fields."""
        return replace(
            self,
            measures={**self.measures, **measures},
            fields={**self.fields, **(fields or {})},
            caveats=rank_caveats((*self.caveats, *caveats)),
        )


@dataclass(frozen=True)
class FinishedStep:
    """The end of a load step, for later ones; its fields are views of those of the result.

    Without an indenter the gap is infinite, and depth and area are those of no contact.
    """

    state: State
    gap: Array
    """Gap [m]; +inf where there is no indenter."""
    displacement: Array
    """Displacement of the surface [m]."""
    area: float
    """Contact area [m²]."""
    energy: float
    """`AdhesiveEquilibrium.energy` [J]; NaN if it is not known."""
    converged: bool
    jumped: bool
    """Whether a part of the contact, or all of it, has jumped."""

    @classmethod
    def of(cls, fields: Mapping[str, Array], numbers: Mapping[str, Any]) -> Self:
        """Return a step from its variables in a result, solved just now or read from a file."""
        pressure = fields["pressure"]
        return cls(
            State(pressure, fields.get("wall_pressure", pressure), numbers.get("depth", nan)),
            fields["gap"] if "gap" in fields else np.broadcast_to(inf, pressure.shape),
            fields["displacement"],
            numbers.get("contact_area", 0.0),
            numbers.get("energy", nan),
            bool(numbers["converged"]),
            bool(numbers.get("jumped", False)),
        )


def end_of(path: Sequence[FinishedStep]) -> tuple[FinishedStep, ...]:
    """Return the last two steps, the earlier one first.

    Only the last one if the path jumped there, and none that did not converge or lies before such a
    step.
    """
    points: list[FinishedStep] = []
    for step in path[-2:]:
        if step.jumped or not step.converged:
            points.clear()
        if step.converged:
            points.append(step)
    return tuple(points)


def start_of(
    problem: Unilateral, state: State | None, path: Sequence[FinishedStep]
) -> State | None:
    """Return the start of a load step: the last two extrapolated to its control, or the last state.

    ``path`` has the last two load steps, the earlier one first; fewer if there are no more.
    Nothing is extrapolated across a reversal of the path, to more than twice the last step, and in
    a solid that relaxes, whose next state also depends on what earlier steps have left behind.
    With a law there may be several equilibria, and the descent from the last state ends in the one
    that the path leads to. Only the front of a law without a range moves on, and not on a bed
    of springs, each of which may be in either of two equilibria.
    """
    if state is None or len(path) < 2 or problem.left is not None:
        return state
    before, last = path
    reached = [control_of(problem, point.state) for point in (before, last)]
    step = reached[1] - reached[0]
    ratio = (problem.value - reached[1]) / step if step else 0.0
    touches = before.state.contact.any() and last.state.contact.any()
    if not 0 < ratio <= _FARTHEST or not touches:
        return state
    if isinstance(problem, Adhesive):
        if problem.operator.is_bed or not problem.law.needs_contact:
            return state
        covered = np.isfinite(problem.profile)
        return moved_on(before.state, last.state, ratio, problem.grid, covered)
    depth = last.state.depth + ratio * (last.state.depth - before.state.depth)
    pressure = _pressure_ahead(problem, before, last, ratio)
    return State(pressure, pressure, depth)


def control_of(problem: Unilateral, state: State) -> float:
    """Return the depth of the base [m] or the force [N] of a state, as `Unilateral.value` is."""
    total = float(state.pressure.sum())
    if isinstance(problem.control, Depth):
        return state.depth + problem.operator.deflection(total)
    return total * problem.grid.cell_area


def _pressure_ahead(
    problem: Unilateral, before: FinishedStep, last: FinishedStep, ratio: float
) -> Array:
    """Return the extrapolated pressure [Pa], > 0 on the extrapolated contact.

    In contact the pressure changes linearly, and cells where it falls to 0 leave. The gap of the
    cells beside the contact changes linearly too; farther away the edge moves evenly through the
    gap to the power 2/3, since the gap grows with the distance to the power 3/2. Cells whose gap
    closes join with a pressure that only marks them.
    """
    contact = last.state.contact
    pressure = last.state.pressure + ratio * (last.state.pressure - before.state.pressure)
    np.maximum(pressure, 0.0, out=pressure)
    # Only cells that came closer can join; a gap is infinite in both steps or in none.
    coming = np.flatnonzero((last.gap < before.gap) & ~contact)
    gaps = [np.maximum(point.gap.ravel()[coming], 0.0) for point in (before, last)]
    linear = gaps[1] + ratio * (gaps[1] - gaps[0])
    one, two = (gap ** (1 / _GAP_POWER) for gap in gaps)
    # Cells beside the contact have an edge in common with one of its cells.
    periodic = problem.grid.boundary == "periodic"
    padded = np.pad(contact, 1, mode="wrap" if periodic else "constant")
    rows, columns = padded[:, 1:-1], padded[1:-1]
    beside = (rows[:-2] | rows[2:] | columns[:, :-2] | columns[:, 2:]).ravel()[coming]
    joins = np.where(beside, linear, two + ratio * (two - one)) < 0
    np.put(pressure, coming[joins], _JOINING * float(pressure.max()))
    return pressure
