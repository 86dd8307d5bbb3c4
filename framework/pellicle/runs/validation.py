"""Solve the validation cases that plugins register."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain

from pellicle.components import Case
from pellicle.config.run import Run
from pellicle.plugins import registry
from pellicle.results.result import Result

from .runner import solve


@dataclass(frozen=True)
class Verdict:
    """A case with the computed value."""

    case: Case
    computed: float
    converged: bool

    @property
    def error(self) -> float:
        """Relative error of the computed value."""
        return abs(self.computed - self.case.expected) / abs(self.case.expected)

    @property
    def passed(self) -> bool:
        """Whether the run converged and the error is within the case's tolerance."""
        return self.converged and self.error <= self.case.tolerance


def validate(cases: Iterable[Case] | None = None) -> Iterator[Verdict]:
    """Yield a verdict on each case; by default on all registered cases.

    Cases that share a configuration share its run.

    Raises
    ------
    ConfigError, PluginError
        A case cannot be run.
    """
    solved: dict[str, Result] = {}
    if cases is None:
        cases = chain.from_iterable(suite() for suite in registry().suites)
    for case in cases:
        key = json.dumps(case.configuration, sort_keys=True)
        if key not in solved:
            # Only the latest run is kept: cases that share one are registered in a row.
            solved = {key: solve(Run(**case.configuration))}
        result = solved[key]
        yield Verdict(case, case.computed(result), result.converged)
