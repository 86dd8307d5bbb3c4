"""A solved load step as one record, from the solve to its copy in the result."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

from .caveats import Caveat, ranked
from .equilibrium import Equilibrium
from .solution import Stop

Value = float | bool | int


class Effort(NamedTuple):
    """The effort of a load step."""

    iterations: int
    """Iterations of the solver, summed over all trials of a search."""
    stop: Stop
    applications: int = 0
    """Applications of the operator on the finest grid."""


class SearchEnd(NamedTuple):
    """How a search for a measured quantity ended."""

    quantity: str
    unit: str
    """SI unit of the quantity."""
    missed: float
    """|value − goal| / |goal|."""
    how: Literal["met", "nearest", "not found"]
    """"nearest" if the quantity jumps across the goal, "not found" if no control passes it."""
    below: float
    """The nearest value below the goal; −∞ if there is none."""
    above: float
    """The nearest value above the goal; ∞ if there is none."""


@dataclass(frozen=True)
class LoadStep:
    """A solved load step; after a search, the trial nearest to the goal.

    It holds the problem and some eight fields, so it must not outlive the copy into the result.
    """

    equilibrium: Equilibrium
    effort: Effort
    jumped: bool = False
    """Whether all contact was gained or lost since the start."""
    search: SearchEnd | None = None
    measures: Mapping[str, Value] = field(default_factory=dict)
    """Numbers besides those of the equilibrium, by the name of their variable."""
    caveats: tuple[Caveat, ...] = ()
    """What limits the step, `ranked`."""

    @property
    def converged(self) -> bool:
        """Whether the numbers of the step may be used, possibly with a caveat."""
        return all(caveat.status.converged for caveat in self.caveats)

    def having(self, measures: Mapping[str, Value], caveats: Iterable[Caveat] = ()) -> LoadStep:
        """Return the step with more measures and caveats."""
        return replace(
            self,
            measures={**self.measures, **measures},
            caveats=ranked((*self.caveats, *caveats)),
        )
