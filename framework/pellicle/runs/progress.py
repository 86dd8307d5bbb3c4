"""Progress bars of a run or a study."""

from __future__ import annotations

import math
import sys
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import TracebackType
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, Self, TextIO, cast

from pellicle.components import Monitor, Say, Task

from .interrupt import Interrupt

if TYPE_CHECKING:
    import rich.console
    import rich.progress

Report = Callable[[int, int, float], None]
"""Function that is called with the number of a load step, the iteration and the residual."""

_BETWEEN_UPDATES = 0.1
_SPEED_PERIOD = 3600
"""Period over which the speed is measured [s]: runs of a study may take minutes each."""


class ProgressMessage(NamedTuple):
    """How far a run has got."""

    step: int
    """The load step being solved, counted from 0."""
    steps: int
    iteration: int
    residual_ratio: float
    """Residual over the tolerance."""
    done: float
    """Number of finished steps, plus the finished share of the current one."""


class Bar(Protocol):
    """The context in which a run is solved; it receives the progress of the run."""

    def __enter__(self) -> object:
        """Start the display, if there is one."""

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End the display."""

    def step(self, index: int) -> Monitor:
        """Return the monitor of a load step, counted from 0."""


class ProgressReporter:
    """Passes the progress of a run to a function, at most ten times a second."""

    def __init__(self, steps: int, say: Say) -> None:
        self._steps, self._say = steps, say

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def step(self, index: int) -> Monitor:
        """Return the monitor of a load step, counted from 0."""
        return _monitor(index, self._steps, self._say)


class _BarContext(ABC):
    """A context with a bar, if there is a terminal, that defers Ctrl-C."""

    def __init__(self, bar: rich.progress.Progress | None) -> None:
        self._bar = bar
        self._interrupt = Interrupt()

    @abstractmethod
    def _begin(self, bar: rich.progress.Progress) -> None:
        """Add the first task to the bar."""

    def __enter__(self) -> Self:
        self._interrupt.hold()
        if self._bar is not None:
            self._bar.start()
            self._begin(self._bar)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.stop()
        self._interrupt.release()
        if kind is None:
            self._interrupt.check()


class RunProgress(_BarContext):
    """Shows a bar on a terminal or in a notebook, or calls a function, or if False does nothing.

    The bar shows the step, the iteration, the residual and the time left. Ctrl-C takes effect at
    the next iteration.
    """

    def __init__(self, steps: int, progress: bool | Report) -> None:
        self._steps = steps
        self._report = progress if callable(progress) else None
        super().__init__(_make_bar(_stderr()) if progress and not self._report else None)

    def _begin(self, bar: rich.progress.Progress) -> None:
        self._task = bar.add_task("", total=float(self._steps), message="")

    def step(self, index: int) -> Monitor:
        """Return the monitor of a load step, counted from 0."""
        show = _monitor(index, self._steps, self._show)

        def monitor(iteration: int, residual_ratio: float) -> None:
            """Show or report an iteration."""
            self._interrupt.check()
            if self._report is not None:
                _report(self._report, index + 1, iteration, residual_ratio)
            elif self._bar is not None:
                show(iteration, residual_ratio)

        return monitor

    def _show(self, message: ProgressMessage) -> None:
        if self._bar is not None:
            self._bar.update(
                self._task,
                completed=message.done,
                description=f"step {message.step + 1}/{message.steps}",
                message=f"iteration {message.iteration} "
                f"residual {message.residual_ratio:.1e} × tolerance",
            )


class BatchProgress(_BarContext):
    """Shows a bar for all tasks and one for each that runs, on a terminal or in a notebook.

    Elsewhere there is a line for each finished task. Ctrl-C takes effect at the next report of a
    task. Nothing is shown if not ``enabled``.
    """

    def __init__(self, total: int, done: int, enabled: bool) -> None:
        self._total, self._done, self._failed = total, done, 0
        self._console = _stderr() if enabled else None
        self._running: dict[str, tuple[rich.progress.TaskID, float]] = {}
        super().__init__(_make_study_bar(self._console) if self._console else None)

    def _begin(self, bar: rich.progress.Progress) -> None:
        self._all = bar.add_task(
            "runs", total=float(self._total), completed=self._done, message=self._count()
        )

    def expect(self, total: int, done: int) -> None:
        """Set the number of tasks, and count ``done`` more that were finished before."""
        self._total = total
        self._done += done
        if self._bar is not None:
            self._bar.update(self._all, total=float(total))
            self._advance()

    def report(self, task: Task, message: ProgressMessage) -> None:
        """Show the progress of a task."""
        self._interrupt.check()
        if self._bar is None:
            return
        if task.name not in self._running:
            task_id = self._bar.add_task(f"  {task.name}", total=float(message.steps), message="")
            self._running[task.name] = task_id, 0.0
        task_id, _ = self._running[task.name]
        self._running[task.name] = task_id, message.done / message.steps
        where = f"step {message.step + 1}/{message.steps} iteration {message.iteration}"
        self._bar.update(task_id, completed=message.done, message=where)
        self._advance()

    def finished(self, task: Task, verdict: str, failed: bool) -> None:
        """Show that a task has finished, with its verdict."""
        self._done += 1
        self._failed += failed
        if self._bar is not None:
            task_id, _ = self._running.pop(task.name, (None, 0.0))
            if task_id is not None:
                self._bar.remove_task(task_id)
            self._advance()
        else:
            self.say(f"[{self._done}/{self._total}] {task.name}: {verdict}")
        self._interrupt.check()

    def say(self, line: str) -> None:
        """Show a line, above the bar if there is one."""
        if self._console is not None:
            self._console.print(line, markup=False, highlight=False, soft_wrap=True)

    def _advance(self) -> None:
        if self._bar is not None:
            running = sum(share for _, share in self._running.values())
            self._bar.update(self._all, completed=self._done + running, message=self._count())

    def _count(self) -> str:
        left = self._total - self._done
        return f"{self._done - self._failed} done, {self._failed} failed, {left} left"


def _monitor(index: int, steps: int, show: Callable[[ProgressMessage], None]) -> Monitor:
    """Return a monitor of a load step that passes its progress on, at most ten times a second."""
    highest, shown_at = 1.0, 0.0

    def monitor(iteration: int, residual_ratio: float) -> None:
        nonlocal highest, shown_at
        now = time.monotonic()
        if now - shown_at < _BETWEEN_UPDATES or not math.isfinite(residual_ratio):
            return
        shown_at = now
        highest = max(highest, residual_ratio)
        # Residuals fall exponentially, so their logarithm advances evenly.
        share = 1 - math.log(max(residual_ratio, 1.0)) / math.log(highest) if highest > 1 else 0.0
        show(ProgressMessage(index, steps, iteration, residual_ratio, index + share))

    return monitor


def _report(report: Report, step: int, iteration: int, residual_ratio: float) -> None:
    try:
        report(step, iteration, residual_ratio)
    except Exception as error:
        # Without a note the error would be attributed to the solver that called the monitor.
        error.add_note(f"raised by progress at iteration {iteration} of step {step}")
        raise


@contextmanager
def status_line(work: str, enabled: bool) -> Iterator[Callable[[str], None]]:
    """Show at which stage some work is; yield a function that sets the stage.

    It is shown on a terminal and in a notebook.
    """
    console = _stderr()
    if enabled and console.is_jupyter:
        from .notebook_bar import NotebookBar

        with NotebookBar() as bar:
            task = bar.add_task(work, total=None, message="")
            yield lambda stage: bar.update(task, message=stage)
        return
    if not (enabled and console.is_terminal):
        yield lambda stage: None
        return
    with console.status(work) as line:
        yield lambda stage: line.update(f"{work}: {stage}")


class _Lasting:
    """A stream on which writing never fails: a log on a full disk must not end a study.

    Of a pipe that nobody reads any more, rich would even end the process.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        with suppress(OSError):
            self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        with suppress(OSError):
            self._stream.flush()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def _stderr() -> rich.console.Console:
    import rich.console

    # Without a standard error, rich writes nowhere.
    file = cast("TextIO", _Lasting(sys.stderr)) if sys.stderr else None
    return rich.console.Console(stderr=True, file=file)


def _make_bar(console: rich.console.Console) -> rich.progress.Progress | None:
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    if console.is_jupyter:
        return _notebook_bar()
    if not console.is_terminal:
        return None
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.fields[message]}"),
        TimeElapsedColumn(),
        *_time_left("left"),
        console=console,
        transient=True,
    )


def _make_study_bar(console: rich.console.Console) -> rich.progress.Progress | None:
    from rich.progress import BarColumn, Progress, TextColumn
    from rich.table import Column
    from rich.text import Text

    if console.is_jupyter:
        return _notebook_bar()
    if not console.is_terminal:
        return None

    class Cut(TextColumn):
        """Column that is shortened first where the terminal is too narrow."""

        def render(self, task: rich.progress.Task) -> Text:
            return Text(task.description, no_wrap=True, overflow="ellipsis")

    return Progress(
        Cut("", table_column=Column(no_wrap=False)),
        BarColumn(bar_width=12),
        TextColumn("{task.fields[message]}", markup=False),
        *_time_left("time left"),
        console=console,
        transient=True,
        speed_estimate_period=_SPEED_PERIOD,
    )


def _notebook_bar() -> rich.progress.Progress:
    from .notebook_bar import NotebookBar

    return NotebookBar(speed_estimate_period=_SPEED_PERIOD)


def _time_left(label: str) -> tuple[rich.progress.ProgressColumn, rich.progress.ProgressColumn]:
    from rich.progress import TextColumn, TimeRemainingColumn

    return TextColumn(label), TimeRemainingColumn()
