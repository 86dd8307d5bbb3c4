"""The tasks of one study on a dask scheduler: which worker gets which task, and when."""

from __future__ import annotations

import ctypes
import pickle
import time
import warnings
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import suppress
from importlib.metadata import version
from math import inf
from queue import Empty, SimpleQueue
from typing import Any, Generic, Self
from uuid import uuid4

import cloudpickle
from dask.base import annotate
from distributed import Client, Future, KilledWorker, get_worker

from pellicle import ConfigError, PellicleError, memory
from pellicle.batch import LockedError
from pellicle.components import AnyTask, Report, Work

from .execution import execute_remotely, pack

_CHECK_INTERVAL = 2.0
"""Time without events after which the scheduler is asked whether a worker is free [s]."""
_END_TIMEOUT = 10.0
"""Largest time to wait for a result, and for running tasks to end at their next report [s]."""
_POLL_INTERVAL = 0.05
_KEPT = {-1: 2**30, -3: 2**25}
"""Options of mallopt of glibc: freed bytes that are kept, bytes of an array of its own."""
_LOCK_TIMEOUT, _LOCK_INTERVAL = 60.0, 1.0
"""Largest time for which files of a task stay locked by a worker that had it before [s]."""
_DISCONNECTED = "the connection to the scheduler was lost"
_MESSAGE, _DONE, _JOINED, _LOST = "message", "done", "add-worker", "remove-worker"
_Room = tuple[int, float, int, float]
"""Threads and memory [bytes] of a worker, and what other clients leave of them."""


class Submission(Generic[AnyTask]):
    """Tasks that go to workers with room for them; unfinished tasks are withdrawn on exit.

    dask counts the threads of a worker but not the memory of its tasks, and attributes its death to
    tasks that only wait there. So a task waits here until a worker has the threads and the memory.
    A task whose worker died is alone on the next ones, and abandoned after as many deaths as the
    scheduler counts. A worker that ends by its lifetime, or because it is asked to, does not die.
    """

    def __init__(
        self, client: Client, work: Work[AnyTask, Any], tasks: Sequence[AnyTask], threads: int
    ) -> None:
        self._client = client
        self._work = work
        self._tasks = list(tasks)
        self._memory = [task.memory for task in tasks]
        self._threads = threads
        self._name = f"pellicle-{uuid4().hex}"
        self._waiting = list(range(len(tasks)))
        self._placed: dict[str, tuple[int, str, Future[bytes]]] = {}
        """Number, address of the worker, and future of each task on a worker."""
        self._begun: set[int] = set()
        self._deaths: dict[int, int] = {}
        """Deaths that a task caused, of each task that was on a worker when it died."""
        self._allowed_deaths = 0
        self._largest = 0.0
        """Memory of the largest worker until now [bytes]."""
        self._events: SimpleQueue[tuple[str, Any]] = SimpleQueue()

    def __enter__(self) -> Self:
        put = self._events.put
        self._client.subscribe_topic(self._name, lambda event: put((_MESSAGE, event[1])))
        self._client.subscribe_topic("all", lambda event: put((event[1]["action"], event[1])))
        return self

    def __exit__(self, *_error: object) -> None:
        client, name = self._client, self._name
        client.cancel([future for _, _, future in self._placed.values()], force=True)
        client.unsubscribe_topic(name)
        client.unsubscribe_topic("all")

        def runs_ours(dask_worker: Any) -> bool:
            return any(str(key).startswith(name) for key in dask_worker.state.tasks)

        end = time.monotonic() + _END_TIMEOUT
        while self._placed and client.status == "running" and time.monotonic() < end:
            # Withdrawn tasks are those of their workers until they end.
            if not any(client.run(runs_ours, on_error="ignore").values()):
                break
            time.sleep(_POLL_INTERVAL)

    def outcomes(self, report: Report[AnyTask]) -> Iterator[tuple[AnyTask, Any]]:
        """Yield each task with its outcome, as they finish."""
        place, warned = True, False
        while True:
            if place and self._events.empty():
                yield from self._place()
                place = False
            if not (self._waiting or self._placed):
                return
            try:
                # Without a timeout Windows would not let Ctrl-C through.
                kind, event = self._events.get(timeout=_CHECK_INTERVAL)
            except Empty:
                place = True
                if not (self._placed or warned) and self._client.status == "running":
                    warned = True
                    warnings.warn(self._shortage(), stacklevel=2)
                continue
            if kind == _MESSAGE:
                report(self._tasks[event[0]], pickle.loads(event[1]))
                continue
            place = True
            if kind == _DONE:
                yield from self._finish(event)
            elif kind in (_JOINED, _LOST):
                ended = kind == _LOST and self._has_ended(event)
                words = "joined" if kind == _JOINED else "has ended" if ended else "was lost"
                # If the scheduler is gone, too, futures tell of it.
                with suppress(OSError):
                    there = len(self._client.nthreads())
                    report(self._tasks[0], f"a worker {words}; there are {there} now")
                if kind == _LOST:
                    yield from self._lose(event["worker"], ended)

    def _place(self) -> Iterator[tuple[AnyTask, Exception]]:
        """Send waiting tasks to workers with room; yield those that cannot be sent, and why."""
        if self._client.status != "running":
            while self._waiting:
                yield self._tasks[self._waiting.pop()], PellicleError(_DISCONNECTED)
        if not self._waiting:
            return
        rooms: dict[str, _Room] = {}
        # The client needs a moment to see that its scheduler is gone.
        with suppress(OSError):
            self._allowed_deaths, rooms = self._client.run_on_scheduler(_rooms(), self._name)
        self._largest = max([self._largest, *(limit for _, limit, _, _ in rooms.values())])
        tasks_of = defaultdict(list)
        for number, address, _ in self._placed.values():
            tasks_of[address].append(number)
        unplaced = inf
        for number in list(self._waiting):
            # What does not fit in this pass does not fit later in it.
            if self._memory[number] >= unplaced:
                continue
            fitting = [a for a, room in rooms.items() if self._fits(number, room, tasks_of[a])]
            if fitting:
                address = min(fitting, key=lambda a: len(tasks_of[a]))
                self._waiting.remove(number)
                try:
                    self._submit(number, address)
                    tasks_of[address].append(number)
                except PellicleError as error:
                    yield self._tasks[number], error
            elif number not in self._deaths:
                unplaced = self._memory[number]
        # Larger workers may join as long as something else is done.
        largest = inf if self._placed or not rooms else self._largest
        for number in [one for one in self._waiting if self._memory[one] > largest]:
            self._waiting.remove(number)
            shortage = memory.shortage(self._memory[number], largest)
            wrong = f"{self._tasks[number].name} needs about {shortage} on the largest worker"
            remedy = "use fewer points or fewer steps, or larger workers"
            yield self._tasks[number], ConfigError(f"{wrong}; {remedy}")

    def _fits(self, number: int, room: _Room, others: list[int]) -> bool:
        """Return whether a worker can execute a task beside the others that it has of us."""
        threads, _, free_threads, free_memory = room
        if others and not self._deaths.keys().isdisjoint([number, *others]):
            return False
        needed = self._memory[number] + sum(self._memory[other] for other in others)
        taken = min(self._threads, threads) * (len(others) + 1)
        return taken <= free_threads and needed <= free_memory

    def _submit(self, number: int, address: str) -> None:
        begun, payload = number in self._begun, pack(self._work, self._tasks[number])
        arguments = payload, version("pellicle"), self._name, number, begun
        key = f"{self._name}-{uuid4().hex}"
        with annotate(pellicle=(self._threads, self._memory[number])):
            future = self._client.submit(_bootstrap(), *arguments, key=key, workers=[address])
        self._begun.add(number)
        self._placed[key] = number, address, future
        future.add_done_callback(lambda _: self._events.put((_DONE, key)))

    def _finish(self, key: str) -> Iterator[tuple[AnyTask, Any]]:
        """Yield a finished task with its outcome, unless its worker died first."""
        number, _, future = self._placed.get(key, (0, "", None))
        outcome = _outcome(future) if future else None
        # The end of its worker is an event of its own.
        if future and not isinstance(outcome, KilledWorker):
            # Dropping the future keeps dask from computing the result again if its worker dies.
            del self._placed[key]
            if outcome is None:
                self._waiting.insert(0, number)
            else:
                yield self._tasks[number], outcome

    def _has_ended(self, removal: dict[str, Any]) -> bool:
        """Return whether a worker ended at its lifetime or by SIGTERM, as of a batch system.

        The scheduler expects the first. A worker with a nanny tells of both.
        """
        log: Any = ()
        with suppress(OSError):
            log = self._client.get_events(removal["worker"])
        actions = [event.get("action") for _, event in log if isinstance(event, dict)]
        # Another worker may have had the address before.
        since = max((i for i, action in enumerate(actions) if action == _JOINED), default=0)
        return bool(removal["expected"]) or "closing-worker" in actions[since:]

    def _lose(self, address: str, ended: bool) -> Iterator[tuple[AnyTask, Any]]:
        """Let the tasks of a worker that is gone wait again; yield those that were its death."""
        lost = [key for key, placed in self._placed.items() if placed[1] == address]
        for number in [self._placed.pop(key)[0] for key in lost]:
            if not ended:
                self._deaths[number] = self._deaths.get(number, 0) + (len(lost) == 1)
            deaths = self._deaths.get(number, 0)
            if deaths <= self._allowed_deaths:
                self._waiting.insert(0 if ended else len(self._waiting), number)
                continue
            yield (
                self._tasks[number],
                PellicleError(
                    f"{deaths} worker{'s' * (deaths > 1)} died of it, as when the system is out of "
                    "memory; the other runs went on"
                ),
            )

    def _shortage(self) -> str:
        if self._client.nthreads():
            return f"no worker has room for {self._tasks[self._waiting[0]].name}; it waits for one"
        return (
            "the dask scheduler has no workers; runs wait until there are some: start them with "
            "`dask worker ADDRESS`, if no queue does"
        )


def _rooms() -> Callable[..., Any]:
    """Return a function for a scheduler: its allowed deaths, its workers by address.

    Of each it tells threads and memory [bytes], and what other clients leave of them.
    """

    def rooms(name: str, dask_scheduler: Any) -> Any:
        found = {}
        for worker in dask_scheduler.running:
            others = [task for task in worker.processing if not str(task.key).startswith(name)]
            shares = [(task.annotations or {}).get("pellicle", (1, 0)) for task in others]
            # A worker without a limit has 0.
            limit = worker.memory_limit or float("inf")
            threads = worker.nthreads - sum(share[0] for share in shares)
            free = limit - sum(share[1] for share in shares)
            found[worker.address] = worker.nthreads, limit, threads, free
        return dask_scheduler.allowed_failures, found

    return rooms


def _bootstrap() -> Callable[..., bytes]:
    """Return `execute_on_worker` in a form that unpickles where pellicle is not installed.

    A nested function is pickled by value. A function pickled by name would end a worker that cannot
    import it, without an error in this process.
    """

    def start(*arguments: Any) -> bytes:
        from pellicle_plugins.executors.dask_tasks import execute_on_worker

        return execute_on_worker(*arguments)

    return start


def execute_on_worker(
    payload: bytes, our_version: str, topic: str, index: int, begun: bool
) -> bytes:
    """Return the pickled outcome of a packed task, which another worker may have ``begun``."""
    if (installed := version("pellicle")) != our_version:
        error = f"the worker has pellicle {installed}, not {our_version} as here; install the same"
        return pickle.dumps(PellicleError(error))
    # dask has freed memory given back at once, which makes a solve take twice as long.
    with suppress(AttributeError, OSError, TypeError):
        for option, value in _KEPT.items():
            ctypes.CDLL(None).mallopt(option, value)
    worker = get_worker()
    key = worker.get_current_task()

    def require_wanted() -> None:
        # dask cannot stop a running task. It changes the state of one whose result is not needed,
        # but not of one that it takes from a worker that ends.
        task = worker.state.tasks.get(key)
        ends = worker.status.name not in ("running", "paused")
        if ends or task is None or task.state != "executing":
            raise CancelledError(f"{key} was withdrawn")

    def say(message: Any) -> None:
        require_wanted()
        worker.log_event(topic, (index, cloudpickle.dumps(message)))

    end = time.monotonic() + _LOCK_TIMEOUT * begun
    while True:
        outcome = execute_remotely(payload, say)
        if time.monotonic() >= end or not isinstance(pickle.loads(outcome), LockedError):
            return outcome
        time.sleep(_LOCK_INTERVAL)
        require_wanted()


def _outcome(future: Future[bytes]) -> Any:
    """Return the outcome of a finished task; None if it was lost with its worker."""
    try:
        return pickle.loads(future.result(timeout=_END_TIMEOUT))
    except CancelledError:
        return PellicleError(_DISCONNECTED)
    except TimeoutError:
        return None
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
