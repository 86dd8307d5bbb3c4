"""What every executor keeps: each task once, its own outcome, and nothing after the end."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from pellicle.components import Executor, Say

from .component import check
from .rules import Rule, require

_TASKS = 7
# Of a task that takes a while [s]; long beside what it takes to close an executor's iterator.
_WHILE = 0.1


def check_executor(executor: Executor) -> None:
    """Check that an executor keeps its contract.

    Beside what all components keep: ``map`` carries out each task once and yields it with what its
    work returned or raised; a failure, ``sys.exit()`` or the death of a worker process stops no
    other task; what work says comes to ``report``, in the calling thread, with its task; and where
    the iterator is closed early, no task goes on.

    Raises
    ------
    AssertionError
        It does not; says what was asked and what was found.
    """
    check(executor, "executor", RULES)


@dataclass(frozen=True)
class Chore:
    """A task that does next to nothing."""

    number: int
    folder: str = ""
    home: int = 0
    """Number of the process that must not die."""
    memory: int = 1_000_000

    @property
    def name(self) -> str:
        """A line for people."""
        return f"chore {self.number}"


def square(task: Chore, say: Say) -> int:
    """Return the square of the task's number."""
    return task.number**2


def talk(task: Chore, say: Say) -> int:
    """Say two things, and do as `square`."""
    say(("begun", task.number))
    say(("nearly done", task.number))
    return task.number**2


def fail_third(task: Chore, say: Say) -> int:
    """Raise for the third task."""
    if task.number == 3:
        raise ValueError("the third task is bad")
    return task.number**2


def exit_third(task: Chore, say: Say) -> int:
    """Leave the interpreter in the third task, as a bad plugin might."""
    if task.number == 3:
        sys.exit(3)
    return task.number**2


def die_third(task: Chore, say: Say) -> int:
    """End the process of the third task, unless it is the one that must not die."""
    if task.number == 3:
        if os.getpid() != task.home:
            os._exit(1)
        raise RuntimeError("would have ended the process")
    return task.number**2


def mark(task: Chore, say: Say) -> int:
    """Leave a file when the task begins, which must be the first time, and one when it ends."""
    with Path(task.folder, f"{task.number} began").open("x"):
        time.sleep(_WHILE)
    Path(task.folder, f"{task.number} ended").touch()
    return task.number**2


def _chores(**fields: Any) -> list[Chore]:
    return [Chore(number, **fields) for number in range(1, _TASKS + 1)]


def _silence(task: Chore, said: Any) -> None:
    pass


def _outcomes(
    executor: Executor, work: Callable[[Chore, Say], Any], **fields: Any
) -> dict[int, Any]:
    """Return the outcome of each task by its number; each must come once."""
    tasks = _chores(home=os.getpid(), **fields)
    pairs = list(executor.map(work, tasks, _silence))
    came = Counter(task.number for task, _ in pairs)
    for task in tasks:
        require(
            came[task.number] == 1,
            f"task {task.number} of {_TASKS} is yielded {came[task.number]} times",
        )
    require(
        {id(task) for task, _ in pairs} == {id(task) for task in tasks},
        "a task is yielded that is not the object that was given",
    )
    return {task.number: outcome for task, outcome in pairs}


def _require_squares(outcomes: dict[int, Any]) -> None:
    for number, outcome in outcomes.items():
        require(outcome == number**2, f"task {number} comes with {outcome!r}, not {number**2}")


def each_task_comes_once_with_its_outcome(executor: Executor) -> None:
    """map() yields each task once, the very object, with what work(task, say) returned."""
    _require_squares(_outcomes(executor, square))


def each_task_is_carried_out_once(executor: Executor) -> None:
    """No task is begun twice or left out, and all have ended when map() has."""
    with TemporaryDirectory() as folder:
        _require_squares(_outcomes(executor, mark, folder=folder))
        wanted = {f"{n} {what}" for n in range(1, _TASKS + 1) for what in ("began", "ended")}
        missing = sorted(wanted - set(os.listdir(folder)))
        require(not missing, f"of the traces of the tasks these are missing: {missing}")


def equal_tasks_are_two_tasks(executor: Executor) -> None:
    """Tasks are told apart by their places, not by what they hold."""
    pairs = list(executor.map(square, [Chore(4), Chore(4)], _silence))
    require([outcome for _, outcome in pairs] == [16, 16], f"two tasks of 4 give {pairs}")


def no_tasks_are_no_trouble(executor: Executor) -> None:
    """Without tasks map() yields nothing."""
    none: list[Chore] = []
    pairs = list(executor.map(square, none, _silence))
    require(not pairs, f"{pairs}")


def failure_is_an_outcome(executor: Executor) -> None:
    """What work raises is yielded as its task's outcome, unchanged, and stops no other task."""
    outcomes = _outcomes(executor, fail_third)
    bad = outcomes.pop(3)
    require(
        isinstance(bad, ValueError) and str(bad) == "the third task is bad",
        f"for ValueError('the third task is bad') task 3 comes with {bad!r}",
    )
    _require_squares(outcomes)


def exit_is_an_outcome(executor: Executor) -> None:
    """Work that calls sys.exit() ends neither the others nor this process: it has failed."""
    try:
        outcomes = _outcomes(executor, exit_third)
    except SystemExit:
        raise AssertionError("sys.exit() in a task leaves map()") from None
    bad = outcomes.pop(3)
    require(isinstance(bad, Exception), f"task 3 comes with {bad!r}, no Exception")
    _require_squares(outcomes)


def death_of_a_worker_is_an_outcome(executor: Executor) -> None:
    """A task that ends its worker process comes with an exception, and stops no other task."""
    outcomes = _outcomes(executor, die_third)
    bad = outcomes.pop(3)
    require(isinstance(bad, Exception), f"task 3 comes with {bad!r}")
    _require_squares(outcomes)


def what_is_said_is_reported(executor: Executor) -> None:
    """report(task, said) is called in this thread, with what that task's work said, in order."""
    here = threading.get_ident(), os.getpid()
    tasks = _chores()
    heard: dict[int, list[Any]] = {id(task): [] for task in tasks}

    def report(task: Chore, said: Any) -> None:
        require((threading.get_ident(), os.getpid()) == here, "report is called in another thread")
        require(id(task) in heard, f"report is called with {task!r}, an object that was not given")
        heard[id(task)].append(tuple(said))

    list(executor.map(talk, tasks, report))
    for task in tasks:
        said = [("begun", task.number), ("nearly done", task.number)]
        came = heard[id(task)]
        require(came == [each for each in said if each in came], f"{task.name} said {came}")


def report_that_raises_ends_the_tasks(executor: Executor) -> None:
    """An interruption of the caller's own, in report, is not swallowed."""
    heard = []

    def report(task: Chore, said: Any) -> None:
        heard.append(said)
        raise KeyboardInterrupt

    try:
        list(executor.map(talk, _chores(), report))
    except KeyboardInterrupt:
        return
    require(not heard, "KeyboardInterrupt raised by report does not come out of map()")


def nothing_goes_on_after_closing(executor: Executor) -> None:
    """Where the iterator is closed early, no task goes on or begins afterwards."""
    with TemporaryDirectory() as folder:
        running = executor.map(mark, _chores(folder=folder), _silence)
        list(islice(running, 1))
        close = getattr(running, "close", None)
        require(close is not None, "map() returns an iterator without close(); write it with yield")
        assert close is not None
        close()
        at_close = set(os.listdir(folder))
        time.sleep(2 * _WHILE)
        later = sorted(set(os.listdir(folder)) - at_close)
        require(not later, f"after close(): {', '.join(later)}")


RULES: list[Rule] = [
    each_task_comes_once_with_its_outcome,
    each_task_is_carried_out_once,
    equal_tasks_are_two_tasks,
    no_tasks_are_no_trouble,
    failure_is_an_outcome,
    exit_is_an_outcome,
    what_is_said_is_reported,
    report_that_raises_ends_the_tasks,
    nothing_goes_on_after_closing,
    death_of_a_worker_is_an_outcome,
]
