"""Executors that break their contract."""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Literal

import pellicle as pl
from tests.framework.broken.catalogue import Broken, Family, Refused, Taken, study


class Executor(pl.Executor):
    """One task after the other, to be broken."""

    type: Literal["broken"] = "broken"

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        for task in tasks:
            yield task, self.attempt(work, task, partial(report, task))

    def attempt(self, work: Any, task: Any, say: Any) -> Any:
        try:
            return work(task, say)
        except Exception as error:
            return error


def _study(executor: Any, folder: Path) -> str:
    try:
        return study(folder, executor)
    except pl.PluginError:
        # What was solved before it was refused is kept, and the rest can follow.
        assert (folder / "study.h5").exists()
        assert study(folder) == "CONVERGED"
        raise


def carries_out(change: Callable[[Any], Any]) -> Any:
    """Return a map of other tasks."""
    return lambda f, work, tasks, report: f(work, change(tasks), report)


def yields(change: Callable[[Any, Any], Any]) -> Any:
    """Return a map that yields something else for each task with its outcome."""
    return lambda f, *given: (change(*pair) for pair in f(*given))


def crossing(f: Any, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
    outcomes = [outcome for _, outcome in f(work, tasks, report)]
    yield from zip(tasks, reversed(outcomes), strict=True)


def twice(f: Any, work: Any, task: Any, say: Any) -> Any:
    first, second = f(work, task, say), f(work, task, lambda text: None)
    return second if isinstance(second, FileExistsError) else first


def fragile(f: Any, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
    with ThreadPoolExecutor(len(tasks)):
        yield from f(work, tasks, report)


def swallowing(f: Any, work: Any, task: Any, say: Any) -> Any:
    try:
        return f(work, task, say)
    except KeyboardInterrupt as error:
        return RuntimeError(str(error))


def lingering(f: Any, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
    attempt, pool = f.__self__.attempt, ThreadPoolExecutor(2)
    futures = [pool.submit(attempt, work, task, lambda text: None) for task in tasks]
    for task, future in zip(tasks, futures, strict=True):
        yield task, future.result()


def halting(f: Any, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
    dead = False
    for task, outcome in f(work, tasks, report):
        yield task, RuntimeError("no worker is left") if dead else outcome
        dead = dead or (isinstance(outcome, Exception) and task.home != 0)


ITSELF = Refused("it has to yield each of the tasks that it was given once, the object itself")
LOST = Refused("map() ended without 1 of 2 tasks, such as reduced modulus 10 kPa")
NOTHING = Refused("with None; it has to yield it with what its work returned or raised")
LISTED = Refused("map() returned [(RunTask(", "it has to be written with yield")
ALONE = Refused("values to unpack", "executor 'broken' failed", error=ValueError)
UNSEEN = Taken("two runs that differ give no trouble, and outcomes do not say whose they are")
BROKEN: dict[str, Any] = {
    "each_task_comes_once_with_its_outcome": [
        Broken("leaves out a task", LOST, map=carries_out(lambda tasks: tasks[1:])),
        Broken("again", ITSELF, map=carries_out(lambda tasks: [*tasks, *tasks[:1]])),
        Broken("yields copies", ITSELF, map=yields(lambda task, out: (replace(task), out))),
        Broken("yields outcomes alone", ALONE, map=yields(lambda task, out: out)),
        Broken("loses outcomes", NOTHING, map=yields(lambda task, out: (task, None))),
        Broken("gives outcomes to other tasks", UNSEEN, map=crossing),
        Broken(
            "takes equal tasks for one",
            UNSEEN,
            map=carries_out(lambda tasks: [*dict.fromkeys(tasks)]),
        ),
    ],
    "each_task_is_executed_once": Broken("carries tasks out twice", UNSEEN, attempt=twice),
    "no_tasks_yield_nothing": Broken("needs a task", UNSEEN, map=fragile),
    "failure_is_an_outcome": [
        Broken(
            "says nothing of an exception",
            UNSEEN,
            attempt=lambda f, *given: None if isinstance(out := f(*given), ValueError) else out,
        ),
        Broken("lets exceptions out", UNSEEN, attempt=lambda f, work, task, say: work(task, say)),
    ],
    "messages_are_reported": Broken(
        "reports all for the first task",
        UNSEEN,
        map=lambda f, work, tasks, report: f(work, tasks, lambda _, text: report(tasks[0], text)),
    ),
    "report_that_raises_ends_the_tasks": Broken("swallows Ctrl-C", UNSEEN, attempt=swallowing),
    "nothing_goes_on_after_closing": [
        Broken("goes on when it is closed", UNSEEN, map=lingering),
        Broken("returns a list", LISTED, map=lambda f, *given: list(f(*given))),
    ],
    "death_of_a_worker_is_an_outcome": Broken("halts when a worker dies", UNSEEN, map=halting),
}
EXECUTORS = Family(Executor, {}, {"study": _study}, ("study",), BROKEN)
