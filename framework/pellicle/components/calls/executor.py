"""Calls of an executor: each task once, with its outcome."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing
from typing import Any, cast

from pellicle.checks import component_name, errors_attributed_to
from pellicle.components.executor import AnyTask, Executor, Outcome, Report, Say
from pellicle.errors import PluginError, shown


def outcomes_of(
    executor: Executor,
    work: Callable[[AnyTask, Say], Outcome],
    tasks: Sequence[AnyTask],
    report: Report[AnyTask],
    kind: type[Outcome],
) -> Generator[tuple[AnyTask, Outcome | Exception], None, None]:
    """Yield each task once with its outcome: a value of type ``kind``, or the exception raised.

    Raises
    ------
    PluginError
        The executor yields a task twice or never, an object that is not one of the tasks, or an
        outcome of another type.
    """
    name = component_name(executor)
    ids = {id(task) for task in tasks}
    remaining = {id(task): task for task in tasks}
    with errors_attributed_to(executor):
        pairs: Any = executor.map(work, tasks, report)
    if not isinstance(pairs, Iterator) or not hasattr(pairs, "close"):
        raise PluginError(f"{name}: map() returned {shown(pairs)}; it has to be written with yield")
    with closing(cast("Generator[Any]", pairs)):
        for pair in _items(executor, pairs):
            if not isinstance(pair, tuple) or len(pair) != 2 or id(pair[0]) not in ids:
                raise PluginError(
                    f"{name}: map() yields {shown(pair)}; it has to yield each of the tasks that "
                    "it was given, the object itself, with its outcome"
                )
            task, outcome = pair
            if remaining.pop(id(task), None) is None:
                raise PluginError(
                    f"{name}: map() yields {task.name} twice; it has to yield each task once"
                )
            if not isinstance(outcome, (kind, Exception)):
                raise PluginError(
                    f"{name}: map() yields {task.name} with {shown(outcome)}; it has to yield it "
                    "with what its work returned or raised"
                )
            yield task, outcome
    if remaining:
        first = next(iter(remaining.values()))
        raise PluginError(
            f"{name}: map() ended without {len(remaining)} of {len(tasks)} tasks, such as "
            f"{first.name}; it has to yield each task once"
        )


def _items(executor: Executor, pairs: Iterator[Any]) -> Iterator[Any]:
    """Yield the items of an executor; exceptions that it raises itself are attributed to it."""
    while True:
        with errors_attributed_to(executor):
            try:
                pair = next(pairs)
            except StopIteration:
                return
        yield pair
