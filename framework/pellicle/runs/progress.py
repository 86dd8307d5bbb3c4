"""The progress of runs and of batches of tasks, and Ctrl-C meanwhile."""

from __future__ import annotations

import math
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import TYPE_CHECKING, NamedTuple, Self

from pellicle.components import Monitor, Task

if TYPE_CHECKING:
    import rich.progress

Report = Callable[[int, int, float], None]
"""Function that is called with the number of a load step, the iteration and the residual."""

_BETWEEN_UPDATES = 0.1


class ProgressMessage(NamedTuple):
    """How far a run has got."""

    step: int
    """The load step being solved, counted from 0."""
    steps: int
    iteration: int
    residual_ratio: float
    """Residual over the tolerance."""
    progress: float
    """Number of finished steps, plus the finished share of the current one."""


class _Progress:
    """A context with bars, if they are wanted and there is where, that defers the first Ctrl-C.

    It takes effect at the next `check`; the second one acts at once. An exception raised at an
    arbitrary point could be lost: Python drops exceptions in finalisers, and every h5py object has
    one.
    """

    def __init__(self, enabled: bool) -> None:
        self._bars = _bars() if enabled else None
        self._holds = self._pressed = False

    def __enter__(self) -> Self:
        is_main = threading.current_thread() is threading.main_thread()
        if is_main and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, self._press)
            self._holds = True
        if self._bars:
            self._bars.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if self._bars:
            self._bars.stop()
        self._release()
        if kind is None:
            self.check()

    def check(self) -> None:
        """Raise KeyboardInterrupt if Ctrl-C has been pressed since the last check."""
        if self._pressed:
            self._pressed = False
            raise KeyboardInterrupt

    def _press(self, *_: object) -> None:
        self._release()
        self._pressed = True

    def _release(self) -> None:
        if self._holds:
            signal.signal(signal.SIGINT, signal.default_int_handler)
            self._holds = False


class RunProgress(_Progress):
    """Shows a bar on a terminal or in a notebook, or calls a function, or if False does nothing.

    The bar shows the step, the iteration, the residual and the time left. Ctrl-C takes effect at
    the next iteration.
    """

    def __init__(self, steps: int, progress: bool | Report) -> None:
        self._steps = steps
        self._report = progress if callable(progress) else None
        super().__init__(bool(progress) and not self._report)
        if self._bars:
            self._task = self._bars.add_task("", total=float(steps), message="")

    def __call__(self, index: int) -> Monitor:
        """Return the monitor of a load step, counted from 0."""

        def update(message: ProgressMessage) -> None:
            assert self._bars
            self._bars.update(
                self._task,
                completed=message.progress,
                description=f"step {message.step + 1}/{message.steps}",
                message=f"iteration {message.iteration} "
                f"residual {message.residual_ratio:.1e} × tolerance",
            )

        show = progress_monitor(index, self._steps, update)

        def monitor(iteration: int, residual_ratio: float) -> None:
            """Show or report an iteration."""
            self.check()
            if self._bars:
                show(iteration, residual_ratio)
            elif self._report:
                try:
                    self._report(index + 1, iteration, residual_ratio)
                except Exception as error:
                    # Without a note it would be attributed to the solver that called the monitor.
                    error.add_note(
                        f"raised by progress at iteration {iteration} of step {index + 1}"
                    )
                    raise

        return monitor


class BatchProgress(_Progress):
    """Shows a bar for all tasks and one for each that runs, on a terminal or in a notebook.

    Elsewhere there is a line for each finished task. Ctrl-C takes effect at the next report of a
    task. Nothing is shown if not ``enabled``. The bar is labelled by what the ``tasks`` are.
    """

    def __init__(self, total: int, done: int, enabled: bool, tasks: str = "runs") -> None:
        super().__init__(enabled)
        self._enabled = enabled
        self._total, self._done, self._failed = total, done, 0
        self._running: dict[str, tuple[rich.progress.TaskID, float]] = {}
        if self._bars:
            self._all = self._bars.add_task(
                tasks, total=float(total), completed=done, message=self._count()
            )

    def expect(self, total: int, done: int) -> None:
        """Set the number of tasks, and count ``done`` more that were finished before."""
        self._total = total
        self._done += done
        if done and self._bars:
            # What was finished before says nothing of the time that is left.
            self._bars.reset(self._all, completed=self._done)
        self._advance()

    def report(self, task: Task, message: ProgressMessage | str) -> None:
        """Show the progress of a task, or a line of text of the executor."""
        self.check()
        if isinstance(message, str):
            self.say(message)
        if not self._bars or isinstance(message, str):
            return
        if task.name in self._running:
            task_id, _ = self._running[task.name]
        else:
            task_id = self._bars.add_task(f"  {task.name}", total=float(message.steps), message="")
        self._running[task.name] = task_id, message.progress / message.steps
        where = f"step {message.step + 1}/{message.steps} iteration {message.iteration}"
        self._bars.update(task_id, completed=message.progress, message=where)
        self._advance()

    def finished(self, task: Task, verdict: str, failed: bool) -> None:
        """Show that a task has finished, with its verdict."""
        self._done += 1
        self._failed += failed
        if not self._bars:
            self.say(f"[{self._done}/{self._total}] {task.name}: {verdict}")
        elif task.name in self._running:
            self._bars.remove_task(self._running.pop(task.name)[0])
        self._advance()
        self.check()

    def say(self, line: str) -> None:
        """Show a line, above the bars if there are any."""
        if self._enabled:
            from rich.console import Console

            console = self._bars.console if self._bars else Console(stderr=True)
            console.print(line, markup=False, highlight=False, soft_wrap=True)

    def _advance(self) -> None:
        if self._bars:
            done = self._done + sum(share for _, share in self._running.values())
            total = float(self._total)
            self._bars.update(self._all, total=total, completed=done, message=self._count())

    def _count(self) -> str:
        left = self._total - self._done
        return f"{self._done - self._failed} done, {self._failed} failed, {left} left"


def progress_monitor(index: int, steps: int, show: Callable[[ProgressMessage], None]) -> Monitor:
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


@contextmanager
def status_line(work: str, enabled: bool) -> Iterator[Callable[[str], None]]:
    """Show at which stage some work is; yield a function that sets the stage.

    It is shown on a terminal and in a notebook.
    """
    bars = _bars() if enabled else None
    if bars is None:
        yield lambda stage: None
        return
    with bars:
        task = bars.add_task(work, total=None, message="")
        yield lambda stage: bars.update(task, message=stage)


def _bars() -> rich.progress.Progress | None:
    # Work that shows nothing does without rich.
    from .bars import bars

    return bars()


Bar = AbstractContextManager[Callable[[int], Monitor]]
"""The context in which a run is solved; it yields the monitor of each load step, from 0."""
