"""The contract of executors."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import (
    Annotated,
    Any,
    ClassVar,
    Protocol,
    TypeVar,
)

from pydantic import BeforeValidator, Field

from pellicle.checks import whole_number

from .base import Component

_Count = Annotated[int, Field(ge=1)]


Threads = Annotated[
    int,
    BeforeValidator(partial(whole_number, unit="threads"), json_schema_input_type=_Count),
]
"""A number of threads ≥ 1; text, fractions and true are refused."""


Workers = Annotated[
    int,
    BeforeValidator(partial(whole_number, unit="workers"), json_schema_input_type=_Count),
]
"""A number of workers ≥ 1, likewise."""


Outcome = TypeVar("Outcome")


class Task(Protocol):
    """A run of a study, as an executor sees it; it pickles."""

    @property
    def name(self) -> str:
        """A line for people."""
        ...

    @property
    def memory(self) -> int:
        """Memory that the task takes while it runs [bytes], estimated."""
        ...


AnyTask = TypeVar("AnyTask", bound=Task)


Report = Callable[[AnyTask, Any], None]
"""Called in the calling process with a task and what its work said."""


Say = Callable[[Any], None]
"""Called by work, wherever it runs, with something small that pickles, for `Report`."""


class Executor(Component):
    """Carries out the runs of a study."""

    family: ClassVar[str] = "executor"

    threads: Annotated[
        Threads | None,
        Field(description="threads of each run's Fourier transforms; if absent, what is fastest"),
    ] = None

    @abstractmethod
    def map(
        self,
        work: Callable[[AnyTask, Say], Outcome],
        tasks: Sequence[AnyTask],
        report: Report[AnyTask],
    ) -> Iterator[tuple[AnyTask, Outcome | Exception]]:
        """Yield each task once, as they finish, with what ``work(task, say)`` returned or raised.

        ``work`` is a picklable function. A task whose worker died comes with an exception that says
        so; it does not stop the others. What ``work`` says reaches ``report`` in this process, as
        soon as may be, or not at all. Where the iterator is closed early, no task goes on.
        """
