"""The tasks of one study on a dask scheduler: which worker gets which task, and when."""

from __future__ import annotations

import pickle
import time
import warnings
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import version
from math import inf
from queue import Empty, SimpleQueue
from typing import Any, Generic, NamedTuple, Self
from uuid import uuid4

from dask.base import annotate
from distributed import Client, Future, KilledWorker

from pellicle import ConfigError, PellicleError, memory
from pellicle.components import AnyTask, Report, Work

from .execution import pack

_CHECK_INTERVAL = 2.0
"""Time without events after which the scheduler is asked whether a worker is free [s]."""
_END_TIMEOUT = 10.0
"""Largest time to wait for a result, and for running tasks to end at their next report [s]."""
_POLL_INTERVAL = 0.05
_DISCONNECTED = "the connection to the scheduler was lost"
_MESSAGE, _DONE, _JOINED, _LOST = "message", "done", "add-worker", "remove-worker"


class _Room(NamedTuple):
    """What a worker has, and what the tasks of other clients leave of it."""

    threads: int
    free_threads: int
    memory: float
    """Limit of its memory [bytes], infinite if it has none."""
    free_memory: float


@dataclass(frozen=True)
class _Placed:
    """A task on a worker."""

    index: int
    address: str
    future: Future[bytes]


class Submission(Generic[AnyTask]):
    """Tasks that go to workers with room for them; unfinished tasks are withdrawn on exit.

    dask counts the threads of a worker but not the memory of its tasks, and attributes its death to
    tasks that only wait there. So a task waits here until a worker has the threads and the memory.
    A task whose worker died is alone on the next ones, and abandoned after as many deaths as the
    scheduler counts. A worker that ends by its lifetime, or because it is asked to, does not die.
    """

    def __init__(
        self,
        client: Client,
        work: Work[AnyTask, Any],
        tasks: Sequence[AnyTask],
        threads: int,
        advice: str,
    ) -> None:
        """Take tasks of so many ``threads``, and what to tell a user who has no workers."""
        self._client = client
        self._work = work
        self._tasks = list(tasks)
        self._memory = [task.memory for task in tasks]
        self._threads = threads
        self._advice = advice
        self._name = f"pellicle-{uuid4().hex}"
        self._waiting = list(range(len(tasks)))
        self._placed: dict[str, _Placed] = {}
        self._begun: set[int] = set()
        self._deaths: dict[int, int] = {}
        """Deaths that a task caused, of each task that was on a worker when it died."""
        self._allowed_deaths = 0
        self._workers: dict[str, _Room] = {}
        self._largest = 0.0
        """Memory of the largest worker until now [bytes]."""
        self._events: SimpleQueue[tuple[str, Any]] = SimpleQueue()

    def __enter__(self) -> Self:
        put = self._events.put
        self._client.subscribe_topic(self._name, lambda event: put((_MESSAGE, event[1])))

        def tell_of_worker(event: tuple[float, Any]) -> None:
            if isinstance(event[1], dict) and event[1].get("action") in (_JOINED, _LOST):
                put((event[1]["action"], event[1]))

        self._client.subscribe_topic("all", tell_of_worker)
        return self

    def __exit__(self, *_error: object) -> None:
        client, name = self._client, self._name
        client.cancel([placed.future for placed in self._placed.values()], force=True)
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
            kind: str = ""
            event: Any = None
            # Without a timeout Windows would not let Ctrl-C through.
            with suppress(Empty):
                kind, event = self._events.get(timeout=_CHECK_INTERVAL)
            if kind == _MESSAGE:
                index, message = event
                report(self._tasks[index], pickle.loads(message))
                continue
            place = True
            if kind == _DONE:
                yield from self._finish(event)
            elif kind:
                ended = kind == _LOST and self._has_ended(event)
                words = "joined" if kind == _JOINED else "has ended" if ended else "was lost"
                workers = len(self._client.nthreads())
                report(self._tasks[0], f"a worker {words}; there are {workers} now")
                if kind == _LOST:
                    yield from self._lose(event["worker"], ended)
            elif not (self._placed or warned):
                warned = True
                warnings.warn(self._shortage(), stacklevel=2)

    def _place(self) -> Iterator[tuple[AnyTask, Exception]]:
        """Send waiting tasks to workers with room; yield those that cannot be sent, and why."""
        if not self._waiting:
            return
        if self._client.status != "running":
            error = PellicleError(_DISCONNECTED)
            yield from ((self._tasks[index], error) for index in self._waiting)
            self._waiting.clear()
            return
        try:
            self._allowed_deaths, rooms = self._client.run_on_scheduler(_rooms(), self._name)
        except OSError:
            # The client needs a moment to see that its scheduler is gone.
            return
        self._workers = {address: _Room(*room) for address, room in rooms.items()}
        self._largest = max([self._largest, *(room.memory for room in self._workers.values())])
        tasks_of = defaultdict(list)
        for placed in self._placed.values():
            tasks_of[placed.address].append(placed.index)
        unplaced = inf
        for index in list(self._waiting):
            # What does not fit in this pass does not fit later in it.
            if self._memory[index] >= unplaced:
                continue
            fitting = [
                a for a, room in self._workers.items() if self._fits(index, room, tasks_of[a])
            ]
            if fitting:
                address = min(fitting, key=lambda a: len(tasks_of[a]))
                tasks_of[address].append(index)
                self._waiting.remove(index)
                try:
                    self._submit(index, address)
                except PellicleError as error:
                    tasks_of[address].remove(index)
                    yield self._tasks[index], error
            elif index not in self._deaths:
                unplaced = self._memory[index]
        if self._workers and not self._placed:
            # Larger workers may join as long as something else is done.
            for index in [i for i in self._waiting if self._memory[i] > self._largest]:
                self._waiting.remove(index)
                yield self._tasks[index], self._too_large(index)

    def _fits(self, index: int, room: _Room, others: list[int]) -> bool:
        """Return whether a worker can execute a task beside the others that it has of us."""
        if others and not self._deaths.keys().isdisjoint([index, *others]):
            return False
        threads = min(self._threads, room.threads) * (len(others) + 1)
        needed = self._memory[index] + sum(self._memory[other] for other in others)
        return threads <= room.free_threads and needed <= room.free_memory

    def _submit(self, index: int, address: str) -> None:
        payload = pack(self._work, self._tasks[index])
        key = f"{self._name}-{uuid4().hex}"
        share = {"threads": self._threads, "memory": self._memory[index]}
        with annotate(pellicle=share):
            future = self._client.submit(
                _bootstrap(),
                payload,
                version("pellicle"),
                self._name,
                index,
                index in self._begun,
                key=key,
                workers=[address],
                pure=False,
            )
        self._begun.add(index)
        self._placed[key] = _Placed(index, address, future)
        future.add_done_callback(lambda _: self._events.put((_DONE, key)))

    def _finish(self, key: str) -> Iterator[tuple[AnyTask, Any]]:
        """Yield a finished task with its outcome, unless its worker died first."""
        if not (placed := self._placed.get(key)):
            return
        outcome = _outcome(placed.future)
        # The end of its worker is an event of its own.
        if not isinstance(outcome, KilledWorker):
            # Dropping the future keeps dask from computing the result again if its worker dies.
            del self._placed[key]
            if outcome is None:
                self._waiting.insert(0, placed.index)
            else:
                yield self._tasks[placed.index], outcome

    def _has_ended(self, removal: dict[str, Any]) -> bool:
        """Return whether a worker ended by itself or was asked to, rather than died.

        The scheduler expects the end of a lifetime, but not that of a job whose batch system sends
        SIGTERM; the worker tells of both if it has a nanny.
        """
        address = removal["worker"]
        log = [event for _, event in self._client.get_events(address) if isinstance(event, dict)]
        actions = [event.get("action") for event in reversed(log)]
        # Another worker may have had the address before.
        latest = actions[: actions.index(_JOINED)] if _JOINED in actions else actions
        return bool(removal["expected"]) or "closing-worker" in latest

    def _lose(self, address: str, ended: bool) -> Iterator[tuple[AnyTask, Any]]:
        """Let the tasks of a worker that is gone wait again; yield those that were its death."""
        lost = {key: task for key, task in self._placed.items() if task.address == address}
        for key, placed in lost.items():
            index = placed.index
            del self._placed[key]
            if not ended:
                self._deaths[index] = self._deaths.get(index, 0) + (len(lost) == 1)
            deaths = self._deaths.get(index, 0)
            if deaths <= self._allowed_deaths:
                self._waiting.insert(0 if ended else len(self._waiting), index)
                continue
            yield (
                self._tasks[index],
                PellicleError(
                    f"{deaths} worker{'s' * (deaths > 1)} died of it, as when the system is out of "
                    "memory; the other runs went on"
                ),
            )

    def _too_large(self, index: int) -> ConfigError:
        shortage = memory.shortage(self._memory[index], self._largest)
        return ConfigError(
            f"{self._tasks[index].name} needs about {shortage} on the largest worker; use fewer "
            "points or fewer steps, or larger workers"
        )

    def _shortage(self) -> str:
        if not self._workers:
            none = "the dask scheduler has no workers; runs wait until there are some"
            return f"{none}: {self._advice}"
        index = self._waiting[0]
        return (
            f"no worker is free for {self._tasks[index].name}, which needs "
            f"{self._memory[index] / 1e9:.3g} GB; it waits for one"
        )


def _rooms() -> Callable[..., Any]:
    """Return the function that asks a scheduler for its workers, pickled as in `_bootstrap`."""

    def rooms(name: str, dask_scheduler: Any) -> Any:
        workers = {}
        for worker in dask_scheduler.running:
            shares = [
                (task.annotations or {}).get("pellicle", {})
                for task in worker.processing
                if not str(task.key).startswith(name) and task not in worker.long_running
            ]
            # A worker without a limit has 0.
            limit = worker.memory_limit or float("inf")
            workers[worker.address] = (
                worker.nthreads,
                worker.nthreads - sum(share.get("threads", 1) for share in shares),
                limit,
                limit - sum(share.get("memory", 0) for share in shares),
            )
        return dask_scheduler.allowed_failures, workers

    return rooms


def _bootstrap() -> Callable[..., bytes]:
    """Return `execute_on_worker` in a form that unpickles where pellicle is not installed.

    A nested function is pickled by value. A function pickled by name would end a worker that cannot
    import it, without an error in this process.
    """

    def start(*arguments: Any) -> bytes:
        from pellicle_plugins.executors.dask_worker import execute_on_worker

        return execute_on_worker(*arguments)

    return start


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
