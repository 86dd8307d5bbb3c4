"""What a run or a study shows and hears while it works: progress bars, and Ctrl-C."""

from __future__ import annotations

import math
import signal
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from types import TracebackType
from typing import TYPE_CHECKING, NamedTuple, Protocol, Self

from pellicle.components import Monitor, Say, Task

if TYPE_CHECKING:
    import rich.console
    import rich.progress

_BETWEEN_UPDATES = 0.1


class Said(NamedTuple):
    """Where a run is."""

    step: int
    """Load step that it works on, counted from 0."""
    steps: int
    iteration: int
    excess: float
    """Residual over the tolerance."""
    done: float
    """Steps finished, the one at work by its share."""


class Bar(Protocol):
    """What a run tells how far it is; a context in which the run is solved."""

    def __enter__(self) -> object:
        """Begin to listen."""

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Cease to listen."""

    def step(self, index: int) -> Monitor:
        """Return the monitor of a load step, counted from 0."""


class Saying:
    """Says where a run is, by a function, every now and then."""

    def __init__(self, steps: int, say: Say) -> None:
        self._steps, self._say = steps, say

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def step(self, index: int) -> Monitor:
        """Return the monitor of a load step, counted from 0."""
        return _monitor(index, self._steps, self._say)


class _Shown(ABC):
    """A context with a bar, if there is a terminal for it, that holds back Ctrl-C."""

    def __init__(self, bar: rich.progress.Progress | None) -> None:
        self._bar = bar
        self._interrupt = _Interrupt()

    @abstractmethod
    def _begin(self, bar: rich.progress.Progress) -> None:
        """Put onto the bar what it shows from the start."""

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


class Progress(_Shown):
    """Shows a bar on a terminal; says nothing where there is none, or when not ``enabled``.

    The bar has the step, the iteration, the residual and the time left. Ctrl-C takes effect at
    the next iteration.
    """

    def __init__(self, steps: int, enabled: bool) -> None:
        self._steps = steps
        console = _terminal() if enabled else None
        super().__init__(None if console is None else _make_bar(console))

    def _begin(self, bar: rich.progress.Progress) -> None:
        self._task = bar.add_task("", total=float(self._steps), said="")

    def step(self, index: int) -> Monitor:
        """Return the monitor of a load step, counted from 0."""
        show = _monitor(index, self._steps, self._show)

        def monitor(iteration: int, excess: float) -> None:
            """Show an iteration; ``excess`` is the residual over the tolerance."""
            self._interrupt.check()
            if self._bar is not None:
                show(iteration, excess)

        return monitor

    def _show(self, said: Said) -> None:
        if self._bar is not None:
            self._bar.update(
                self._task,
                completed=said.done,
                description=f"step {said.step + 1}/{said.steps}",
                said=f"iteration {said.iteration} residual {said.excess:.1e} × tolerance",
            )


class StudyProgress(_Shown):
    """Shows a bar for a study and one for each run at work; without a terminal, a line a run.

    Ctrl-C takes effect when a run next says something. Nothing is shown when not ``enabled``.
    """

    def __init__(self, total: int, done: int, enabled: bool) -> None:
        self._total, self._done, self._failed = total, done, 0
        self._console = _stderr() if enabled else None
        is_terminal = self._console is not None and self._console.is_terminal
        self._running: dict[str, tuple[rich.progress.TaskID, float]] = {}
        super().__init__(_make_study_bar(self._console) if self._console and is_terminal else None)

    def _begin(self, bar: rich.progress.Progress) -> None:
        self._all = bar.add_task(
            "runs", total=float(self._total), completed=self._done, said=self._count()
        )

    def report(self, task: Task, said: Said) -> None:
        """Show where a run is."""
        self._interrupt.check()
        if self._bar is None:
            return
        if task.name not in self._running:
            shown = self._bar.add_task(f"  {task.name}", total=float(said.steps), said="")
            self._running[task.name] = shown, 0.0
        shown, _ = self._running[task.name]
        self._running[task.name] = shown, said.done / said.steps
        where = f"step {said.step + 1}/{said.steps} iteration {said.iteration}"
        self._bar.update(shown, completed=said.done, said=where)
        self._advance()

    def finished(self, task: Task, verdict: str, failed: bool) -> None:
        """Show that a run is done, and how it ended."""
        self._done += 1
        self._failed += failed
        if self._bar is not None:
            shown, _ = self._running.pop(task.name, (None, 0.0))
            if shown is not None:
                self._bar.remove_task(shown)
            self._advance()
        elif self._console is not None:
            line = f"[{self._done}/{self._total}] {task.name}: {verdict}"
            self._console.print(line, markup=False, highlight=False, soft_wrap=True)
        self._interrupt.check()

    def _advance(self) -> None:
        if self._bar is not None:
            at_work = sum(share for _, share in self._running.values())
            self._bar.update(self._all, completed=self._done + at_work, said=self._count())

    def _count(self) -> str:
        left = self._total - self._done
        return f"{self._done - self._failed} done, {self._failed} failed, {left} left"


def _monitor(index: int, steps: int, tell: Callable[[Said], None]) -> Monitor:
    """Return a monitor of a load step that tells where it is, but not at every iteration."""
    highest, told = 1.0, 0.0

    def monitor(iteration: int, excess: float) -> None:
        nonlocal highest, told
        now = time.monotonic()
        if now - told < _BETWEEN_UPDATES or not math.isfinite(excess):
            return
        told = now
        highest = max(highest, excess)
        # Residuals fall exponentially, so the logarithm is what advances evenly.
        share = 1 - math.log(max(excess, 1.0)) / math.log(highest) if highest > 1 else 0.0
        tell(Said(index, steps, iteration, excess, index + share))

    return monitor


class _Interrupt:
    """Holds back the first Ctrl-C until `check`; the second acts at once.

    Raised just anywhere it could be lost: Python drops what is raised in a finaliser, and every
    object of HDF5 has one.
    """

    def __init__(self) -> None:
        self._holds = self._pressed = False

    def hold(self) -> None:
        is_main = threading.current_thread() is threading.main_thread()
        if is_main and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, self._press)
            self._holds = True

    def release(self) -> None:
        if self._holds:
            signal.signal(signal.SIGINT, signal.default_int_handler)
            self._holds = False

    def _press(self, *_: object) -> None:
        self.release()
        self._pressed = True

    def check(self) -> None:
        if self._pressed:
            self._pressed = False
            raise KeyboardInterrupt


def _stderr() -> rich.console.Console:
    import rich.console

    return rich.console.Console(stderr=True)


def _terminal() -> rich.console.Console | None:
    console = _stderr()
    return console if console.is_terminal else None


def _make_bar(console: rich.console.Console) -> rich.progress.Progress:
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.fields[said]}"),
        TimeElapsedColumn(),
        *_time_left("left"),
        console=console,
        transient=True,
    )


def _make_study_bar(console: rich.console.Console) -> rich.progress.Progress:
    from rich.progress import BarColumn, Progress, TextColumn
    from rich.table import Column
    from rich.text import Text

    class Cut(TextColumn):
        """Gives way to the other columns where the terminal is too narrow for all."""

        def render(self, task: rich.progress.Task) -> Text:
            return Text(task.description, no_wrap=True, overflow="ellipsis")

    return Progress(
        Cut("", table_column=Column(no_wrap=False)),
        BarColumn(bar_width=12),
        TextColumn("{task.fields[said]}", markup=False),
        *_time_left("time left"),
        console=console,
        transient=True,
        # A study's runs take minutes each: a speed of the last half minute means nothing.
        speed_estimate_period=3600,
    )


def _time_left(label: str) -> tuple[rich.progress.ProgressColumn, rich.progress.ProgressColumn]:
    from rich.progress import TextColumn, TimeRemainingColumn

    return TextColumn(label), TimeRemainingColumn()
