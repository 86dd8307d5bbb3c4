"""Solve the validation cases that plugins register."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain, groupby

from pellicle.components import Case
from pellicle.components.installed import registry
from pellicle.config.run import Run

from .runner import solve


@dataclass(frozen=True)
class CheckedCase:
    """A case with the computed value."""

    case: Case
    computed: float
    converged: bool
    problem: str = ""
    """Why there is no computed value, which is NaN then."""

    @property
    def error(self) -> float:
        """Relative error of the computed value."""
        return abs(self.computed - self.case.expected) / abs(self.case.expected)

    @property
    def passed(self) -> bool:
        """Whether the run converged and the error is within the case's tolerance."""
        return self.converged and self.error <= self.case.tolerance


def validate(cases: Iterable[Case] | None = None) -> Iterator[CheckedCase]:
    """Yield each case with its computed value; by default all registered cases.

    Cases in a row that share a configuration share its run. One that cannot be run is a ConfigError
    or a PluginError.
    """
    if cases is None:
        cases = chain.from_iterable(suite() for suite in registry().suites)
    for _, group in groupby(cases, lambda case: json.dumps(case.configuration, sort_keys=True)):
        sharing = list(group)
        result = solve(Run(**sharing[0].configuration))
        for case in sharing:
            try:
                computed, problem = float(case.computed(result)), ""
            # Whatever a plugin's function raises, the other cases are checked.
            except Exception as error:
                computed, problem = math.nan, f"{type(error).__name__}: {error}"
            yield CheckedCase(case, computed, result.converged, problem)
