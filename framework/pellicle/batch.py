"""Many tasks by an executor: the lock of their folder, their progress, and the loop over them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing
from typing import Any

from pellicle.checks import component_name, errors_attributed_to
from pellicle.components import AnyTask, Executor, Outcome, Say
from pellicle.errors import PluginError, shown
from pellicle.runs.lock import locked as locked
from pellicle.runs.progress import BatchProgress as BatchProgress
from pellicle.runs.progress import status_line as status_line


def mapped(
    executor: Executor,
    work: Callable[[AnyTask, Say], Outcome],
    tasks: Sequence[AnyTask],
    kind: type[Outcome],
    keep: Callable[[AnyTask, Outcome | Exception], tuple[str, bool]],
    progress: BatchProgress,
) -> None:
    """Execute tasks, and keep the outcome of each as soon as it is there.

    An error of one task does not end the others. Ctrl-C does, at the next report or outcome.
    ``executor``, ``work`` and ``tasks`` are as for `Executor.map`. ``keep`` is called with a task
    and its outcome, a value of type ``kind`` or the exception that was raised, and returns a
    verdict in words, and whether the task failed. ``progress`` is the bar, inside its context.

    Raises
    ------
    PluginError
        The executor yields a task twice or never, an object that is not one of the tasks, or an
        outcome of another type.
    """
    name = component_name(executor)
    remaining = {id(task): task for task in tasks}
    with errors_attributed_to(executor):
        pairs: Any = executor.map(work, tasks, progress.report)
    if not hasattr(pairs, "close"):
        raise PluginError(f"{name}: map() returned {shown(pairs)}; it has to be written with yield")
    with closing(pairs):
        while True:
            with errors_attributed_to(executor):
                pair = next(pairs, None)
                if pair is None:
                    break
                task, outcome = pair
            if remaining.pop(id(task), None) is None:
                raise PluginError(
                    f"{name}: map() yields {shown(task)}; it has to yield each of the tasks that "
                    "it was given once, the object itself"
                )
            if not isinstance(outcome, (kind, Exception)):
                raise PluginError(
                    f"{name}: map() yields {task.name} with {shown(outcome)}; it has to yield it "
                    "with what its work returned or raised"
                )
            progress.finished(task, *keep(task, outcome))
    if remaining:
        first = next(iter(remaining.values()))
        raise PluginError(
            f"{name}: map() ended without {len(remaining)} of {len(tasks)} tasks, such as "
            f"{first.name}; it has to yield each task once"
        )
