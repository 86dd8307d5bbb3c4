"""Many tasks by an executor: their locks, their parts, their progress, and the loop over them."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Any, TypeVar

from pellicle.checks import component_name, errors_attributed_to
from pellicle.components import AnyTask, Executor, Outcome, Say
from pellicle.errors import ConfigError, PluginError, excerpt
from pellicle.runs.lock import LockedError as LockedError
from pellicle.runs.lock import lock_files as lock_files
from pellicle.runs.progress import BatchProgress as BatchProgress
from pellicle.runs.progress import status_line as status_line

_Any = TypeVar("_Any")


@dataclass(frozen=True)
class Part:
    """The share of many tasks that one of several processes does: every ``count``-th task.

    All of them is a part too; each is left to whoever has locked it first.
    """

    number: int = 1
    count: int = 1

    @classmethod
    def of_text(cls, text: str | None) -> Part | None:
        """Return the part that a text such as 3/40 or any means, None for none."""
        if text in (None, "any"):
            return None if text is None else cls()
        match = re.fullmatch(r"(\d{1,9})/(\d{1,9})", text)
        if match and 1 <= int(match[1]) <= int(match[2]):
            return cls(int(match[1]), int(match[2]))
        raise ConfigError(f"{excerpt(text)} is neither any nor a part such as 3/40", "part")

    def of(self, tasks: Sequence[_Any]) -> Sequence[_Any]:
        """Return the tasks of this part."""
        return tasks[self.number - 1 :: self.count]


def run_tasks(
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
        raise PluginError(
            f"{name}: map() returned {excerpt(pairs)}; it has to be written with yield"
        )
    with closing(pairs):
        while True:
            with errors_attributed_to(executor):
                pair = next(pairs, None)
                if pair is None:
                    break
                task, outcome = pair
            if remaining.pop(id(task), None) is None:
                raise PluginError(
                    f"{name}: map() yields {excerpt(task)}; it has to yield each of the tasks that "
                    "it was given once, the object itself"
                )
            if not isinstance(outcome, (kind, Exception)):
                raise PluginError(
                    f"{name}: map() yields {task.name} with {excerpt(outcome)}; it has to yield it "
                    "with what its work returned or raised"
                )
            progress.finished(task, *keep(task, outcome))
    if remaining:
        first = next(iter(remaining.values()))
        raise PluginError(
            f"{name}: map() ended without {len(remaining)} of {len(tasks)} tasks, such as "
            f"{first.name}; it has to yield each task once"
        )
