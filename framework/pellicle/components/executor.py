"""The contract of executors."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Annotated, Any, ClassVar, Protocol, TypeVar

from pydantic import BeforeValidator, Field

from pellicle.checks import whole_number
from pellicle.plugins.component import Component


def _count(unit: str) -> BeforeValidator:
    schema = Annotated[int, Field(ge=1)]
    return BeforeValidator(partial(whole_number, unit=unit), json_schema_input_type=schema)


Threads = Annotated[int, _count("threads")]
"""A number of threads ≥ 1; text, fractions and true are refused."""
Workers = Annotated[int, _count("workers")]
"""A number of workers ≥ 1, likewise."""

Outcome = TypeVar("Outcome")


class Task(Protocol):
    """A run of a study, as an executor sees it; it can be pickled."""

    @property
    def name(self) -> str:
        """The name of the task in messages, on one line."""

    @property
    def memory(self) -> int:
        """Estimated peak memory of the task [bytes]."""


AnyTask = TypeVar("AnyTask", bound=Task)

Report = Callable[[AnyTask, Any], None]
"""Function that the executor calls in the calling process with a task and a progress message.

A message that is text is shown as a line: a worker that joins, one that is lost.
"""
Say = Callable[[Any], None]
"""Function that work calls, in any process, with a small picklable message for `Report`."""
Work = Callable[[AnyTask, Say], Outcome]
"""A picklable function that executes a task."""
Outcomes = Iterator[tuple[AnyTask, Outcome | Exception]]
"""Tasks with the value that their work returned, or the exception that it raised."""


class Executor(Component):
    """Executes the runs of a study."""

    family: ClassVar[str] = "executor"
    place: ClassVar[str] = "study.executor"

    threads: Threads | None = Field(
        None, description="threads of each run's arrays and transforms; if absent, what is fastest"
    )

    @abstractmethod
    def map(
        self, work: Work[AnyTask, Outcome], tasks: Sequence[AnyTask], report: Report[AnyTask]
    ) -> Outcomes[AnyTask, Outcome]:
        """Yield each task once, as they finish, with what ``work(task, say)`` returned or raised.

        If a worker dies, its task is yielded with an exception that states this, and the other
        tasks continue. Messages that ``work`` passes to ``say`` are passed to ``report`` in this
        process, soon or not at all. If the iterator is closed early, no task continues.
        """
