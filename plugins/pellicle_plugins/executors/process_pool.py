"""A pool of worker processes that starts tasks as cores and memory allow."""

from __future__ import annotations

import os
import pickle
import signal
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from queue import SimpleQueue
from typing import Any, Generic

import cloudpickle
import loky  # noqa: F401  (makes the start method "loky" known)

from pellicle import ConfigError, PellicleError, memory
from pellicle.components import AnyTask, Report, Work

from .execution import execute_remotely, pack

_MESSAGE, _OUTCOME = b"m", b"o"


class Worker:
    """A worker process, as its parent sees it.

    loky starts a new process instead of forking one that may have threads. It does not import the
    parent's ``__main__``, so neither a script without ``if __name__ == "__main__"`` nor a notebook
    is run again. cloudpickle sends their definitions by value.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        self.connection, theirs = get_context("loky").Pipe()
        self.process = get_context("loky").Process(  # type: ignore[attr-defined]
            target=_serve, args=(theirs,), daemon=True, env=dict(environment)
        )
        with theirs, _interrupts_blocked():
            self.process.start()

    def start(self, payload: bytes) -> None:
        """Send a packed task."""
        # If the worker has died in the meantime, `receive` returns its death as the outcome.
        with suppress(OSError):
            self.connection.send_bytes(payload)

    def receive(self) -> tuple[bool, Any]:
        """Return True and the outcome of the task, or False and a message of its work.

        Call this when `connection` is ready. The death of the worker is an outcome too.
        """
        try:
            message = self.connection.recv_bytes()
        except (EOFError, OSError):
            self.process.join()
            code = self.process.exitcode
            cause = f"exit code {code}" if code >= 0 else signal.Signals(-code).name
            if cause == "SIGKILL":
                cause += ", as when the system is out of memory"
            return True, PellicleError(f"its worker died: {cause}; the other runs go on")
        return message[:1] == _OUTCOME, pickle.loads(message[1:])

    def end(self) -> None:
        """Terminate the process and wait for its end."""
        self.connection.close()
        self.process.terminate()
        self.process.join()


@contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Block Ctrl-C within this context, and permanently in processes started within it."""
    if sys.platform == "win32":
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _serve(connection: Connection[Any, Any]) -> None:
    """Execute tasks until the parent terminates this process or dies."""
    # A terminal sends Ctrl-C to workers too, but the parent decides when they end.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    payloads: SimpleQueue[bytes] = SimpleQueue()
    threading.Thread(target=_listen, args=(connection, payloads), daemon=True).start()

    def say(message: Any) -> None:
        connection.send_bytes(_MESSAGE + cloudpickle.dumps(message))

    while True:
        connection.send_bytes(_OUTCOME + execute_remotely(payloads.get(), say))


def _listen(connection: Connection[Any, Any], payloads: SimpleQueue[bytes]) -> None:
    """Receive tasks; exit at once when the parent has died, even by SIGKILL."""
    try:
        while True:
            payloads.put(connection.recv_bytes())
    except (EOFError, OSError):
        os._exit(1)


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

    def outcomes(self, report: Report[AnyTask]) -> Iterator[tuple[AnyTask, Any]]:
        """Yield each task with its outcome as it finishes, and report messages meanwhile.

        All workers end with the iterator.
        """
        try:
            finished = self._start()
            while self._running or finished:
                yield from finished
                # The next tasks start before the caller handles the finished ones.
                finished = self._receive(report)
                finished += self._start()
        finally:
            for worker in [*self._idle, *(worker for worker, _ in self._running.values())]:
                worker.end()

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
                while self._idle and not self._idle[-1].process.is_alive():
                    self._idle.pop().end()
                worker = self._idle.pop() if self._idle else Worker(self._environment)
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
