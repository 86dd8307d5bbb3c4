"""For each rule of executors: an executor that breaks it, and only it, by a little."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from typing import Any, Literal

import pytest

import pellicle as pl
from pellicle import testing
from tests.framework.testing.mutants import check_base, check_mutant, rules_of


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
        except SystemExit as error:
            return RuntimeError(str(error))


class Dropping(Executor):
    """Leaves out the last of many tasks."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        yield from super().map(work, tasks[:5], report)


class Repeating(Executor):
    """Yields the first task again."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        yield from super().map(work, [*tasks, *tasks[:1]], report)


class Twice(Executor):
    """Carries tasks out twice to be sure, and yields them once."""

    def attempt(self, work: Any, task: Any, say: Any) -> Any:
        first = super().attempt(work, task, say)
        second = super().attempt(work, task, lambda text: None)
        return second if isinstance(second, FileExistsError) else first


class Copying(Executor):
    """Yields copies of tasks."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        for task, outcome in super().map(work, tasks, report):
            yield replace(task), outcome


class Crossing(Executor):
    """Gives outcomes to the wrong tasks."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        outcomes = [outcome for _, outcome in super().map(work, tasks, report)]
        yield from zip(tasks, reversed(outcomes), strict=True)


class Caching(Executor):
    """Takes equal tasks for one."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        yield from super().map(work, list(dict.fromkeys(tasks)), report)


class Fragile(Executor):
    """Needs a task."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        with ThreadPoolExecutor(len(tasks)):
            yield from super().map(work, tasks, report)


class Hiding(Executor):
    """Says None for an exception."""

    def attempt(self, work: Any, task: Any, say: Any) -> Any:
        outcome = super().attempt(work, task, say)
        return None if isinstance(outcome, ValueError) else outcome


class Raising(Executor):
    """Lets an exception out."""

    def attempt(self, work: Any, task: Any, say: Any) -> Any:
        return work(task, say)


class Leaving(Executor):
    """Lets ``sys.exit()`` out."""

    def attempt(self, work: Any, task: Any, say: Any) -> Any:
        try:
            return work(task, say)
        except Exception as error:
            return error


class Confusing(Executor):
    """Reports everything for the first task."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        for task in tasks:
            yield task, self.attempt(work, task, partial(report, tasks[0]))


class Swallowing(Executor):
    """Keeps what report raises to itself."""

    def attempt(self, work: Any, task: Any, say: Any) -> Any:
        try:
            return super().attempt(work, task, say)
        except KeyboardInterrupt as error:
            return RuntimeError(str(error))


class Lingering(Executor):
    """Goes on when nobody listens any more."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        pool = ThreadPoolExecutor(2)
        futures = [pool.submit(self.attempt, work, task, lambda text: None) for task in tasks]
        for task, future in zip(tasks, futures, strict=True):
            yield task, future.result()


class Halting(Executor):
    """Carries out nothing more once a worker has died."""

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        dead = False
        for task, outcome in super().map(work, tasks, report):
            yield task, RuntimeError("no worker is left") if dead else outcome
            dead = dead or "ended the process" in str(outcome)


EXECUTORS = {
    Dropping: "each_task_comes_once_with_its_outcome",
    Repeating: "each_task_comes_once_with_its_outcome",
    Copying: "each_task_comes_once_with_its_outcome",
    Crossing: "each_task_comes_once_with_its_outcome",
    Twice: "each_task_is_executed_once",
    Caching: "equal_tasks_are_two_tasks",
    Fragile: "no_tasks_yield_nothing",
    Hiding: "failure_is_an_outcome",
    Raising: "failure_is_an_outcome",
    Leaving: "exit_is_an_outcome",
    Confusing: "messages_are_reported",
    Swallowing: "report_that_raises_ends_the_tasks",
    Lingering: "nothing_goes_on_after_closing",
    Halting: "death_of_a_worker_is_an_outcome",
}


@pytest.mark.parametrize(
    ("mutant", "rule"), EXECUTORS.items(), ids=lambda value: getattr(value, "__name__", "")
)
def test_mutant_is_caught(mutant: Any, rule: str) -> None:
    """The message names the class, the rule, what is asked and what was found."""
    check_mutant("executor", mutant(), rule)


def test_what_the_mutants_are_made_of_is_whole() -> None:
    """Without its fault each mutant breaks nothing but that no plugin registers it."""
    check_base("executor", Executor())


def test_each_rule_has_a_mutant(monkeypatch: pytest.MonkeyPatch) -> None:
    """No rule could be dropped, or say yes to everything, without a test that fails."""
    assert rules_of("executor", monkeypatch) == set(EXECUTORS.values())


def test_what_a_component_raises_is_the_cause() -> None:
    """An error of the author's own code comes with its traceback."""
    with pytest.raises(AssertionError, match="ValueError") as caught:
        testing.check_executor(Raising())
    assert isinstance(caught.value.__cause__, ValueError)
