"""One run after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Literal

from pellicle import hookimpl
from pellicle.components import AnyTask, Executor, Outcome, Report, Say

from .execution import attempt


class Serial(Executor):
    """One run after the other, in this process."""

    type: Literal["serial"] = "serial"

    def map(
        self,
        work: Callable[[AnyTask, Say], Outcome],
        tasks: Sequence[AnyTask],
        report: Report[AnyTask],
    ) -> Iterator[tuple[AnyTask, Outcome | Exception]]:
        """Yield each task, in order, with what ``work`` returned or raised."""
        for task in tasks:
            yield task, attempt(work, task, partial(report, task))


@hookimpl
def register_executors(register: Callable[[type[Executor]], None]) -> None:
    """Register the executor."""
    register(Serial)
