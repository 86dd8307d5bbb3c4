"""Progress bars in a notebook, as HTML."""

from __future__ import annotations

import time
from html import escape
from importlib import import_module
from typing import Any

from rich.progress import Progress, Task, TaskID

_BEFORE_SHOWN = 0.5
_BETWEEN_UPDATES = 0.2


class NotebookBar(Progress):
    """Shows the tasks of a `rich.progress.Progress` as one output of a cell, which is updated.

    Work shorter than half a second shows nothing, and nothing stays when the work ends. The
    notebook display of rich itself needs ipywidgets.
    """

    def start(self) -> None:
        """Begin to count the time."""
        self._begun = time.monotonic()
        self._shown_at = 0.0
        self._handle: Any = None

    def stop(self) -> None:
        """Take the bars away."""
        if self._handle is not None:
            self._show("")

    def update(self, task_id: TaskID, **values: Any) -> None:
        """Change a task and show all."""
        super().update(task_id, **values)
        now = time.monotonic()
        if now - self._begun >= _BEFORE_SHOWN and now - self._shown_at >= _BETWEEN_UPDATES:
            self._shown_at = now
            self._show("".join(map(_line, self.tasks)))

    def _show(self, html: str) -> None:
        ipython = import_module("IPython.display")
        content = ipython.HTML(html)
        if self._handle is None:
            self._handle = ipython.display(content, display_id=True)
        else:
            self._handle.update(content)


def _line(task: Task) -> str:
    """Return the line of a task: name, bar, message and the time left."""
    is_indeterminate = task.total is None
    value = "" if is_indeterminate else f" max='{task.total:.6g}' value='{task.completed:.6g}'"
    seconds = task.time_remaining
    left = "" if seconds is None else f", time left {_clock(int(seconds))}"
    return (
        f"<div style='white-space:nowrap'>{escape(task.description)} "
        f"<progress{value} style='vertical-align:middle'></progress> "
        f"{escape(task.fields['message'])}{left}</div>"
    )


def _clock(seconds: int) -> str:
    return f"{seconds // 3600}:{seconds // 60 % 60:02d}:{seconds % 60:02d}"
