"""Bars of progress, by rich: on a terminal and in a notebook the same."""

from __future__ import annotations

import math
import time
from importlib import import_module
from typing import Any

import rich.console
from rich.progress import BarColumn, Progress, Task, TaskID, TextColumn, TimeRemainingColumn
from rich.table import Column
from rich.text import Text

_BEFORE_SHOWN = 0.5
"""Time after which a notebook shows the bars [s]: nothing is to flicker."""
_BETWEEN_UPDATES = 0.2
_SPEED_PERIOD = 3600
"""Period over which the speed is measured [s]: runs of a study may take minutes each."""


def bars() -> Progress | None:
    """Return bars for the terminal or the notebook of standard error; None elsewhere.

    A task has a field ``message``, and no time left if its total is None.
    """
    console = rich.console.Console(stderr=True)
    if not (console.is_jupyter or console.is_terminal):
        return None
    return (NotebookBars if console.is_jupyter else Progress)(
        _Name("", table_column=Column(no_wrap=False)),
        BarColumn(bar_width=12),
        TextColumn("{task.fields[message]}", markup=False),
        _TimeLeft(),
        console=console,
        transient=True,
        speed_estimate_period=_SPEED_PERIOD,
    )


class NotebookBars(Progress):
    """The bars as one output of a cell, which is updated, and empty when the work ends.

    The notebook display of rich itself needs ipywidgets.
    """

    _next = math.inf
    _output: Any = None

    def start(self) -> None:
        """Begin to count the time."""
        self._next = time.monotonic() + _BEFORE_SHOWN

    def stop(self) -> None:
        """Take the bars away."""
        if self._output is not None:
            self._output.update(import_module("IPython.display").HTML(""))

    def update(self, task_id: TaskID, **values: Any) -> None:
        """Change a task and show all."""
        super().update(task_id, **values)
        if (now := time.monotonic()) < self._next:
            return
        self._next = now + _BETWEEN_UPDATES
        table = self.make_tasks_table(self.tasks)
        if self._output is None:
            self._output = import_module("IPython.display").display(table, display_id=True)
        else:
            self._output.update(table)


class _Name(TextColumn):
    """The description of a task, which is shortened first where there is no room for all."""

    def render(self, task: Task) -> Text:
        return Text(task.description, no_wrap=True, overflow="ellipsis")


class _TimeLeft(TimeRemainingColumn):
    def render(self, task: Task) -> Text:
        left = super().render(task)
        return left if task.total is None else Text("time left ").append_text(left)
