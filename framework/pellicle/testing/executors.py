"""Contract rules of executors: each task once, with its outcome, and nothing after the end."""

from __future__ import annotations

import os
import threading
import time
from collections import Counter
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple
from uuid import uuid4

from pellicle.components import Executor, Say

from .component import check, require, rules_of
from .small_runs import ignore

_TASKS = 7
_DURATION = 0.1
"""Time that a slow task takes [s], long compared with closing an executor's iterator."""


def check_executor(executor: Executor) -> None:
    """Check that an executor keeps its contract: the rules below, and those of all components."""
    check(executor, Executor, rules_of(__name__))


@dataclass(frozen=True)
class Chore:
    """A task that does almost nothing."""

    number: int
    folder: str = ""
    home: int = 0
    """Id of the process that must not die; 0 if no process of a task is to end."""
    memory: int = 1_000_000

    @property
    def name(self) -> str:
        """One line for people."""
        return f"chore {self.number}"


def _work(task: Chore, say: Say) -> int:
    """Send two messages, leave two files if the task has a folder; return its number squared."""
    say(("begun", task.number))
    say(("nearly done", task.number))
    if task.folder:
        unique = uuid4().hex
        Path(task.folder, f"{task.number} began {unique}").touch()
        time.sleep(_DURATION)
        Path(task.folder, f"{task.number} ended {unique}").touch()
    return task.number**2


def _fail_third(task: Chore, say: Say) -> int:
    """Raise in the third task, or end its process if that may die."""
    if task.number == 3:
        if task.home not in (0, os.getpid()):
            os._exit(1)
        raise ValueError("the third task is bad")
    return task.number**2


def _chores(**fields: Any) -> list[Chore]:
    return [Chore(number, **fields) for number in range(1, _TASKS + 1)]


def _require_squares(
    tasks: list[Chore], pairs: list[tuple[Chore, Any]], *, but: int = 0
) -> dict[int, Any]:
    """Require each task once, itself, and with its square but for one; return the outcomes."""
    for task in tasks:
        outcomes = [outcome for yielded, outcome in pairs if yielded is task]
        times, square = len(outcomes), task.number**2
        require(times == 1, f"{task.name} of {len(tasks)} is yielded {times} times as it was given")
        right = task.number == but or outcomes[0] == square
        require(right, f"{task.name} comes with {outcomes[0]!r}, not {square}")
    return {task.number: outcome for task, outcome in pairs}


class Observations(NamedTuple):
    """Observations of tasks that succeed, of which the last two are equal."""

    tasks: list[Chore]
    pairs: list[tuple[Chore, Any]]
    messages: list[tuple[Chore, Any]]
    callers: set[tuple[int, int]]
    """Threads and processes in which `report` was called."""
    traces: list[str]


@lru_cache(maxsize=1)
def _observed(executor: Executor) -> Observations:
    """Execute nine tasks, for several rules: an executor may start slowly."""
    messages: list[tuple[Chore, Any]] = []
    callers = set()

    def report(task: Chore, message: Any) -> None:
        callers.add((threading.get_ident(), os.getpid()))
        messages.append((task, message))

    with TemporaryDirectory() as folder:
        tasks = [*_chores(folder=folder), Chore(8), Chore(8)]
        pairs = list(executor.map(_work, tasks, report))
        return Observations(tasks, pairs, messages, callers, os.listdir(folder))


def each_task_comes_once_with_its_outcome(executor: Executor) -> None:
    """map() yields each task once, the object itself, though others may be equal to it.

    It comes with the return value of work(task, say).
    """
    observed = _observed(executor)
    _require_squares(observed.tasks, observed.pairs)


def each_task_is_executed_once(executor: Executor) -> None:
    """Each task is executed exactly once, and all have ended when map() ends."""
    counts = Counter(trace.rpartition(" ")[0] for trace in _observed(executor).traces)
    for number in range(1, _TASKS + 1):
        for event in ("began", "ended"):
            times = counts[f"{number} {event}"]
            require(times == 1, f"when map() has ended, task {number} {event} {times} times")


def no_tasks_yield_nothing(executor: Executor) -> None:
    """Without tasks map() yields nothing."""
    none: list[Chore] = []
    pairs = list(executor.map(_work, none, ignore))
    require(not pairs, f"{pairs}")


def failure_is_an_outcome(executor: Executor) -> None:
    """An exception of work is yielded unchanged as its task's outcome, and stops no other task."""
    tasks = _chores()
    bad = _require_squares(tasks, list(executor.map(_fail_third, tasks, ignore)), but=3)[3]
    require(
        isinstance(bad, ValueError) and str(bad) == "the third task is bad",
        f"for ValueError('the third task is bad') task 3 comes with {bad!r}",
    )


def messages_are_reported(executor: Executor) -> None:
    """report(task, message) is called in this thread, with the messages of the task in order."""
    observed = _observed(executor)
    caller = threading.get_ident(), os.getpid()
    require(observed.callers <= {caller}, "report is called in another thread")
    for task, _ in observed.messages:
        passed = any(task is known_task for known_task in observed.tasks)
        require(passed, f"report is called with {task!r}, not one of the tasks")
    for task in observed.tasks:
        sent = [("begun", task.number), ("nearly done", task.number)]
        received = [tuple(message) for owner, message in observed.messages if owner is task]
        in_order = [message for message in sent if message in received]
        require(received == in_order, f"{task.name} sent {sent}, and report received {received}")


def report_that_raises_ends_the_tasks(executor: Executor) -> None:
    """An interruption raised by report comes out of map()."""
    messages = []

    def report(task: Chore, message: Any) -> None:
        messages.append(message)
        raise KeyboardInterrupt

    try:
        list(executor.map(_work, _chores(), report))
    except KeyboardInterrupt:
        return
    require(not messages, "KeyboardInterrupt raised by report does not come out of map()")


def nothing_goes_on_after_closing(executor: Executor) -> None:
    """After the iterator is closed early, no task continues or begins."""
    with TemporaryDirectory() as folder:
        running: Any = executor.map(_work, _chores(folder=folder), ignore)
        list(islice(running, 1))
        running.close()
        at_close = set(os.listdir(folder))
        time.sleep(2 * _DURATION)
        later = sorted(set(os.listdir(folder)) - at_close)
        require(not later, f"after close(): {', '.join(later)}")


def death_of_a_worker_is_an_outcome(executor: Executor) -> None:
    """A task that ends its worker process comes with an exception, and stops no other task."""
    tasks = _chores(home=os.getpid())
    bad = _require_squares(tasks, list(executor.map(_fail_third, tasks, ignore)), but=3)[3]
    require(isinstance(bad, Exception), f"task 3 comes with {bad!r}")
