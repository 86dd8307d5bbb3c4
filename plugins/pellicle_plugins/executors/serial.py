"""One run after the other."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Literal

from pellicle.components import AnyTask, Executor, Outcome, Outcomes, Report, Work

from .execution import execute


class Serial(Executor):
    """One run after the other, in this process."""

    type: Literal["serial"] = "serial"
    examples = ({"threads": 1},)

    def map(
        self, work: Work[AnyTask, Outcome], tasks: Sequence[AnyTask], report: Report[AnyTask]
    ) -> Outcomes[AnyTask, Outcome]:
        """Yield each task, in order, with what ``work`` returned or raised."""
        for task in tasks:
            yield task, execute(work, task, partial(report, task))
