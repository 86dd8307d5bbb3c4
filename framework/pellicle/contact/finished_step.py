"""A load step as it is left to those after it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import nan
from typing import Any, Self

from pellicle.arrays import Array

from .solution import State
from .start import PathPoint


@dataclass(frozen=True)
class FinishedStep:
    """What a load step leaves to those after it; its fields are views of those of the result."""

    state: State
    gap: Array
    """Gap [m]; +inf where there is no indenter."""
    displacement: Array
    """Displacement of the surface [m]."""
    area: float
    """Contact area [m²]."""
    energy: float
    """`Equilibrium.energy` [J]; NaN if it is not known."""
    converged: bool
    jumped: bool
    """Whether a part of the contact, or all of it, has jumped."""

    @classmethod
    def of(cls, fields: Mapping[str, Array], numbers: Mapping[str, Any]) -> Self:
        """Return a step from its variables in a result, solved just now or read from a file."""
        pressure = fields["pressure"]
        return cls(
            State(pressure, fields.get("wall_pressure", pressure), numbers["depth"]),
            fields["gap"],
            fields["displacement"],
            numbers["contact_area"],
            numbers.get("energy", nan),
            bool(numbers["converged"]),
            bool(numbers.get("jumped", False)),
        )


def end_of(path: Sequence[FinishedStep]) -> tuple[PathPoint, ...]:
    """Return the last two steps, the earlier one first.

    Only the last one if the path jumped there, and none that did not converge or lies before such a
    step.
    """
    points: list[PathPoint] = []
    for step in path[-2:]:
        if step.jumped or not step.converged:
            points.clear()
        if step.converged:
            points.append(PathPoint(step.state, step.gap, step.energy))
    return tuple(points)
