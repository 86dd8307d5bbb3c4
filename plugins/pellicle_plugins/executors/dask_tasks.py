"""The tasks of one study on a dask scheduler."""

from __future__ import annotations

import ctypes
import pickle
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import suppress
from importlib.metadata import version
from math import inf
from queue import Empty, SimpleQueue
from typing import Any, Generic, Self
from uuid import uuid4

import cloudpickle
from distributed import Client, Future, KilledWorker, get_worker

from pellicle import ConfigError, PellicleError, memory
from pellicle.components import AnyTask, Report, Work

from .execution import execute_remotely, pack

_CHECK_INTERVAL = 2.0
"""Time without events after which the scheduler is asked whether it has workers [s]."""
_END_TIMEOUT = 10.0
"""Largest time to wait for running tasks to end at their next report [s]."""
_POLL_INTERVAL = 0.05
_WORKERS = {"add-worker": "a worker joined", "remove-worker": "a worker was lost"}
"""Words for the events of workers of which the scheduler tells."""
_KEPT = {-1: 2**30, -3: 2**25}
"""Options of mallopt of glibc: freed bytes that are kept, bytes of an array of its own."""


class Submission(Generic[AnyTask]):
    """Tasks that are submitted on entry; unfinished tasks are withdrawn on exit."""

    def __init__(self, client: Client, work: Work[AnyTask, Any], tasks: Sequence[AnyTask]) -> None:
        self._client = client
        self._work = work
        self._tasks = list(tasks)
        self._name = f"pellicle-{uuid4().hex}"
        self._futures: dict[int, Future[bytes]] = {}
        self._events: SimpleQueue[tuple[int, bytes | str | None]] = SimpleQueue()
        self._refused: list[tuple[AnyTask, Exception]] = []

    def __enter__(self) -> Self:
        self._client.subscribe_topic(self._name, lambda event: self._events.put(event[1]))
        self._client.subscribe_topic("all", self._tell_of_worker)
        workers = self._client.scheduler_info()["workers"].values()
        limits = [worker["memory_limit"] for worker in workers]
        # A worker without a limit has 0.
        largest = max(limits) if limits and all(limits) else inf
        for index, task in enumerate(self._tasks):
            try:
                if task.memory > largest:
                    raise ConfigError(
                        f"{task.name} needs about {memory.shortage(task.memory, largest)} on the "
                        "largest worker; use fewer points or fewer steps, or larger workers"
                    )
                self._submit(index)
            except PellicleError as error:
                self._refused.append((task, error))
        return self

    def __exit__(self, *_error: object) -> None:
        client, name = self._client, self._name
        client.cancel(list(self._futures.values()), force=True)
        client.unsubscribe_topic(name)
        client.unsubscribe_topic("all")

        def runs_ours(dask_worker: Any) -> bool:
            return any(str(key).startswith(name) for key in dask_worker.state.tasks)

        end = time.monotonic() + _END_TIMEOUT
        while self._futures and client.status == "running" and time.monotonic() < end:
            # Withdrawn tasks are those of their workers until they end.
            if not any(client.run(runs_ours, on_error="ignore").values()):
                break
            time.sleep(_POLL_INTERVAL)

    def outcomes(self, report: Report[AnyTask]) -> Iterator[tuple[AnyTask, Any]]:
        """Yield each task with its outcome, as they finish.

        dask attributes the death of a worker to all its tasks, including waiting ones. So the tasks
        that it abandons are submitted once more after the others, one at a time.
        """
        yield from self._refused
        suspects: list[int] = []
        for index, outcome in self._finished(report):
            if isinstance(outcome, KilledWorker):
                suspects.append(index)
            else:
                yield self._tasks[index], outcome
        for suspect in suspects:
            self._submit(suspect)
            for index, outcome in self._finished(report):
                if isinstance(outcome, KilledWorker):
                    deaths = outcome.allowed_failures + 1
                    outcome = PellicleError(
                        f"{deaths} worker{'s' * (deaths > 1)} died of it, as when the system is "
                        "out of memory; the other runs went on"
                    )
                yield self._tasks[index], outcome

    def _tell_of_worker(self, event: tuple[float, dict[str, Any]]) -> None:
        if words := _WORKERS.get(event[1]["action"]):
            self._events.put((0, words))

    def _submit(self, index: int) -> None:
        future = self._client.submit(
            _bootstrap(),
            pack(self._work, self._tasks[index]),
            version("pellicle"),
            self._name,
            index,
            key=f"{self._name}-{uuid4().hex}",
            pure=False,
        )
        self._futures[index] = future
        future.add_done_callback(lambda _: self._events.put((index, None)))

    def _finished(self, report: Report[AnyTask]) -> Iterator[tuple[int, Any]]:
        """Yield the outcome of each submitted task, and report messages meanwhile."""
        warned = False
        while self._futures:
            try:
                # Without a timeout Windows would not let Ctrl-C through.
                index, message = self._events.get(timeout=_CHECK_INTERVAL)
            except Empty:
                if not warned and not self._client.scheduler_info()["workers"]:
                    warned = True
                    warnings.warn(
                        "the dask scheduler has no workers; runs wait until there are some: start "
                        "them with `dask worker ADDRESS`",
                        stacklevel=2,
                    )
                continue
            if isinstance(message, str):
                report(self._tasks[0], f"{message}; there are {len(self._client.nthreads())} now")
            elif message is not None:
                report(self._tasks[index], pickle.loads(message))
            elif index in self._futures:
                # Dropping the future keeps dask from computing the result again if its worker dies.
                yield index, _outcome(self._futures.pop(index))


def _bootstrap() -> Callable[..., bytes]:
    """Return `execute_on_worker` in a form that unpickles where pellicle is not installed.

    A nested function is pickled by value. A function pickled by name would end a worker that cannot
    import it, without an error in this process.
    """

    def start(*arguments: Any) -> bytes:
        from pellicle_plugins.executors.dask_tasks import execute_on_worker

        return execute_on_worker(*arguments)

    return start


def execute_on_worker(payload: bytes, our_version: str, topic: str, index: int) -> bytes:
    """Return the pickled outcome of a packed task, on a worker."""
    if (installed := version("pellicle")) != our_version:
        error = f"the worker has pellicle {installed}, not {our_version} as here; install the same"
        return pickle.dumps(PellicleError(error))
    # dask has freed memory given back at once, which makes a solve take twice as long.
    with suppress(AttributeError, OSError, TypeError):
        for option, value in _KEPT.items():
            ctypes.CDLL(None).mallopt(option, value)
    worker = get_worker()
    key = worker.get_current_task()

    def say(message: Any) -> None:
        # dask cannot stop a running task, but changes its state when its result is not needed.
        task = worker.state.tasks.get(key)
        if task is None or task.state != "executing":
            raise CancelledError(f"{key} was withdrawn")
        worker.log_event(topic, (index, cloudpickle.dumps(message)))

    return execute_remotely(payload, say)


def _outcome(future: Future[bytes]) -> Any:
    try:
        return pickle.loads(future.result())
    except CancelledError:
        return PellicleError("the connection to the scheduler was lost")
    except Exception as error:
        cause: BaseException | None = error
        while cause is not None and not isinstance(cause, ModuleNotFoundError):
            cause = cause.__cause__
        if cause is None:
            return error
        return PellicleError(
            f"scheduler or workers lack {cause.name}; install there what is installed here, "
            "pip install 'pellicle[cluster]' at the least"
        )
