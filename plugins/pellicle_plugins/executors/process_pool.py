"""The worker processes of one study, and which task is whose."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection, wait
from types import TracebackType
from typing import Any, Generic, Self

from pellicle import ConfigError, memory
from pellicle.components import AnyTask, Report, Say

from .execution import pack
from .worker import Worker

_LIMITS = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
"""Variables that bound the threads of linear algebra, read when its library is loaded."""
_WORKER_MEMORY = 150_000_000
"""A worker with pellicle and its libraries loaded takes this [bytes], whatever its task."""

Outcomes = list[tuple[AnyTask, Any]]


class Crew(Generic[AnyTask]):
    """Workers that share tasks; no more are at work than fit into memory.

    Parameters
    ----------
    work
        What each task is handed to.
    tasks
        The tasks; begun in this order, but that a small one may overtake a large one.
    most
        Workers at once.
    threads
        Threads of each worker's linear algebra.
    """

    def __init__(
        self, work: Callable[[AnyTask, Say], Any], tasks: Sequence[AnyTask], most: int, threads: int
    ) -> None:
        self._work = work
        self._waiting = list(tasks)
        self._most = most
        self._environment = dict.fromkeys(_LIMITS, str(threads))
        self._idle: list[Worker] = []
        self._at_work: dict[Connection[Any, Any], tuple[Worker, AnyTask]] = {}
        self._room: float | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for worker in [*self._idle, *(worker for worker, _ in self._at_work.values())]:
            worker.end()

    @property
    def busy(self) -> bool:
        """Whether a task is being carried out."""
        return bool(self._at_work)

    def begin(self) -> Outcomes[AnyTask]:
        """Begin as many tasks as may be; return those that cannot be, with the reason."""
        refused: Outcomes[AnyTask] = []
        while self._waiting and len(self._at_work) < self._most:
            there = memory.available()
            if not self._at_work:
                self._room = there
            fitting = (i for i, task in enumerate(self._waiting) if self._fits(task, there))
            index = next(fitting, None)
            if index is None:
                if self._at_work:
                    break
                task = self._waiting.pop(0)
                refused.append((task, _too_large(task, there)))
                continue
            task = self._waiting.pop(index)
            try:
                parcel = pack(self._work, task)
                worker = self._worker()
            except Exception as error:
                refused.append((task, error))
                continue
            self._at_work[worker.connection] = worker, task
            worker.begin(parcel)
        return refused

    def listen(self, report: Report[AnyTask]) -> Outcomes[AnyTask]:
        """Wait for the workers to say something; return the tasks that are finished by it."""
        finished: Outcomes[AnyTask] = []
        # wait() of nothing would return at once.
        for connection in wait(list(self._at_work)) if self._at_work else []:
            assert isinstance(connection, Connection)
            worker, task = self._at_work[connection]
            is_outcome, said = worker.receive()
            if not is_outcome:
                report(task, said)
                continue
            del self._at_work[connection]
            self._idle.append(worker)
            finished.append((task, said))
        return finished

    def _worker(self) -> Worker:
        while self._idle:
            worker = self._idle.pop()
            if worker.alive:
                return worker
            worker.end()
        return Worker(self._environment)

    def _fits(self, task: AnyTask, there: float | None) -> bool:
        """Whether a task fits into what is available now, and beside what the others may yet take.

        The others have taken some of their memory already, and nobody can tell how much; so the
        tasks at work are held against what was available when there were none.
        """
        if there is None or self._room is None:
            return True
        needed = _needed(task)
        others = sum(_needed(other) for _, other in self._at_work.values())
        return needed <= there and others + needed <= self._room


def _needed(task: Any) -> float:
    return float(task.memory) + _WORKER_MEMORY


def _too_large(task: Any, there: float | None) -> ConfigError:
    assert there is not None
    return ConfigError(
        f"{task.name} needs about {memory.shortage(_needed(task), there)}; use fewer points or "
        "fewer steps"
    )
