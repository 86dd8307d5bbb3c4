"""What a run shows and hears while it iterates: a progress bar, and Ctrl-C."""

from __future__ import annotations

import math
import signal
import threading
import time
from types import TracebackType
from typing import TYPE_CHECKING, Self

from .components import Monitor

if TYPE_CHECKING:
    import rich.progress

_BETWEEN_UPDATES = 0.1


class Progress:
    """Shows a bar on a terminal; says nothing where there is none, or when not ``enabled``.

    The bar has the step, the iteration, the residual and the time left. Ctrl-C takes effect at
    the next iteration.
    """

    def __init__(self, steps: int, enabled: bool) -> None:
        self._steps = steps
        self._bar = _make_bar() if enabled else None
        self._updated = 0.0
        self._interrupt = _Interrupt()

    def __enter__(self) -> Self:
        self._interrupt.hold()
        if self._bar is not None:
            self._bar.start()
            self._task = self._bar.add_task("", total=float(self._steps), iteration=0, excess=0.0)
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

    def step(self, index: int) -> Monitor:
        """Return the monitor of a load step, counted from 0."""
        highest = 1.0

        def monitor(iteration: int, excess: float) -> None:
            """Show an iteration; ``excess`` is the residual over the tolerance."""
            nonlocal highest
            self._interrupt.check()
            now = time.monotonic()
            if self._bar is None or now - self._updated < _BETWEEN_UPDATES:
                return
            if not math.isfinite(excess):
                return
            self._updated = now
            highest = max(highest, excess)
            # Residuals fall exponentially, so the logarithm is what advances evenly.
            done = 1 - math.log(max(excess, 1.0)) / math.log(highest) if highest > 1 else 0.0
            self._bar.update(
                self._task,
                completed=index + done,
                description=f"step {index + 1}/{self._steps}",
                iteration=iteration,
                excess=excess,
            )

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


def _make_bar() -> rich.progress.Progress | None:
    import rich.console
    from rich.progress import (
        BarColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    console = rich.console.Console(stderr=True)
    if not console.is_terminal:
        return None
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("iteration {task.fields[iteration]}"),
        TextColumn("residual {task.fields[excess]:.1e} × tolerance"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
        console=console,
        transient=True,
    )
