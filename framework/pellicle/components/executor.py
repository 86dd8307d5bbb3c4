"""The contract of executors."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Annotated, Any, ClassVar, Protocol, TypeVar

from pydantic import BeforeValidator, Field

from pellicle.checks import whole_number

from .base import Component


def _count(unit: str) -> BeforeValidator:
    schema = Annotated[int, Field(ge=1)]
    return BeforeValidator(partial(whole_number, unit=unit), json_schema_input_type=schema)


Threads = Annotated[int, _count("threads")]
"""A number of threads ≥ 1; text, fractions and true are refused."""
Workers = Annotated[int, _count("workers")]
"""A number of workers ≥ 1, likewise."""

Outcome = TypeVar("Outcome")


class Task(Protocol):
    """A run of a study, as an executor sees it; it pickles."""

    @property
    def name(self) -> str:
        """One line for people."""
        ...

    @property
    def memory(self) -> int:
        """Estimated memory of the running task [bytes]."""
        ...


AnyTask = TypeVar("AnyTask", bound=Task)

Report = Callable[[AnyTask, Any], None]
"""Called in the calling process with a task and a message of its work."""
Say = Callable[[Any], None]
"""Called by work, wherever it runs, with a small message that pickles, for `Report`."""
Work = Callable[[AnyTask, Say], Outcome]
"""A picklable function that executes a task."""
Outcomes = Iterator[tuple[AnyTask, Outcome | Exception]]
"""Tasks with what their work returned or raised."""


class Executor(Component):
    """Carries out the runs of a study."""

    family: ClassVar[str] = "executor"

    threads: Annotated[
        Threads | None,
        Field(description="threads of each run's Fourier transforms; if absent, what is fastest"),
    ] = None

    @abstractmethod
    def map(
        self, work: Work[AnyTask, Outcome], tasks: Sequence[AnyTask], report: Report[AnyTask]
    ) -> Outcomes[AnyTask, Outcome]:
        """Yield each task once, as they finish, with what ``work(task, say)`` returned or raised.

        A task whose worker died comes with an exception that says so; it does not stop the others.
        Messages that ``work`` passes to ``say`` are passed to ``report`` in this process, soon or
        not at all. If the iterator is closed early, no task goes on.
        """
