"""A pool of worker processes that starts tasks as cores and memory allow."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from multiprocessing.connection import Connection, wait
from typing import Any, Generic, Self

from pellicle import ConfigError, memory
from pellicle.components import AnyTask, Report, Work

from .execution import pack
from .worker import Worker

_THREAD_VARIABLES = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
"""Environment variables with a number of threads, read by linear algebra libraries on loading."""


class ProcessPool(Generic[AnyTask]):
    """At most so many workers that share tasks; only as many run at once as fit into memory.

    Tasks start in their order, except that a small one may overtake a large one.
    """

    def __init__(
        self, work: Work[AnyTask, Any], tasks: Sequence[AnyTask], workers: int, threads: int
    ) -> None:
        self._work = work
        self._waiting = list(tasks)
        self._limit = workers
        self._environment = dict.fromkeys(_THREAD_VARIABLES, str(threads))
        self._idle: list[Worker] = []
        self._running: dict[Connection[Any, Any], tuple[Worker, AnyTask]] = {}
        self._free_memory: float | None = None
        """Memory available when no task was running [bytes]; None if unknown."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        for worker in [*self._idle, *(worker for worker, _ in self._running.values())]:
            worker.end()

    def outcomes(self, report: Report[AnyTask]) -> Iterator[tuple[AnyTask, Any]]:
        """Yield each task with its outcome as it finishes, and report messages meanwhile."""
        finished = self._start()
        while self._running or finished:
            yield from finished
            # The next tasks start before the caller handles the finished ones.
            finished = self._receive(report)
            finished += self._start()

    def _start(self) -> list[tuple[AnyTask, Any]]:
        """Start as many tasks as possible; return those that cannot start, with the error."""
        refused: list[tuple[AnyTask, Any]] = []
        while self._waiting and len(self._running) < self._limit:
            available = memory.available()
            if not self._running:
                self._free_memory = available
            fitting = (i for i, task in enumerate(self._waiting) if self._fits(task, available))
            index = next(fitting, None)
            if index is None and self._running:
                break
            task = self._waiting.pop(index or 0)
            try:
                if index is None:
                    assert available is not None
                    raise ConfigError(
                        f"{task.name} needs about {memory.shortage(_needed(task), available)}; use "
                        "fewer points or fewer steps"
                    )
                payload = pack(self._work, task)
                worker = self._worker()
            except Exception as error:
                refused.append((task, error))
                continue
            self._running[worker.connection] = worker, task
            worker.start(payload)
        return refused

    def _receive(self, report: Report[AnyTask]) -> list[tuple[AnyTask, Any]]:
        """Wait for messages of the workers; return the tasks that have finished."""
        finished: list[tuple[AnyTask, Any]] = []
        # Without connections, wait() would return at once.
        for connection in wait(list(self._running)) if self._running else []:
            assert isinstance(connection, Connection)
            worker, task = self._running[connection]
            is_outcome, message = worker.receive()
            if not is_outcome:
                report(task, message)
                continue
            del self._running[connection]
            self._idle.append(worker)
            finished.append((task, message))
        return finished

    def _worker(self) -> Worker:
        while self._idle:
            worker = self._idle.pop()
            if worker.alive:
                return worker
            worker.end()
        return Worker(self._environment)

    def _fits(self, task: AnyTask, available: float | None) -> bool:
        """Return whether a task fits into the available memory, and beside the running tasks.

        Running tasks have already allocated an unknown part of their estimated memory, so the sum
        of the estimates is compared with the memory available when no task was running.
        """
        if available is None or self._free_memory is None:
            return True
        needed = _needed(task)
        running = sum(_needed(other) for _, other in self._running.values())
        return needed <= available and running + needed <= self._free_memory


def _needed(task: Any) -> float:
    return float(task.memory) + memory.PROCESS
