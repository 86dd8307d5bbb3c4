"""When runs are solved while sliders move: previews at once, the run itself at rest."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any, Final

from bokeh.document import Document

from .frames import Frame, preview, solved

# Time without a change after which a run is solved in full [ms]: while a slider moves, previews
# alone follow it.
_REST: Final = 150
# Time after which a solve is abandoned if another run waits [s]. A typed tension of 1 MN/m may take
# minutes; but if every solve were abandoned, a contact that sticks would not follow a slider.
_LONGEST_WAIT: Final = 0.5


class _AbandonedError(Exception):
    """A solve whose result is not wanted any more."""


class Solving:
    """Solves the newest of the runs that are requested, one at a time, in another thread.

    A run is solved to a few digits first, from the frame before, which takes a third of the time or
    less, and in full once nothing has been requested for a while.

    Parameters
    ----------
    target
        The document in whose thread ``show`` is called.
    show
        Called with the document of a run and its frame, or the exception that it raised.
    """

    def __init__(
        self, target: Document, show: Callable[[Mapping[str, Any], Frame | Exception], None]
    ) -> None:
        self._target, self._show = target, show
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="explorer")
        self._is_working = self._is_closed = False
        self._waiting: Mapping[str, Any] | None = None
        self._shown: Mapping[str, Any] | None = None
        self.frame: Frame | None = None
        """The last frame."""

    def request(self, configuration: Mapping[str, Any]) -> None:
        """Solve a run, once the one that is being solved is finished."""
        if self._is_working:
            self._waiting = configuration
        else:
            self._start(configuration, self.frame)

    def close(self) -> None:
        """Solve and show nothing more."""
        self._is_closed = True
        self._thread.shutdown(wait=False, cancel_futures=True)

    def _start(self, configuration: Mapping[str, Any], start: Frame | None) -> None:
        """Solve a run in the other thread, as a preview if there is a ``start``."""
        if not self._is_closed:
            self._is_working, self._waiting = True, None
            self._thread.submit(self._solve, configuration, start)

    def _solve(self, configuration: Mapping[str, Any], start: Frame | None) -> None:
        start_time = time.monotonic()

        def check() -> None:
            is_late = self._waiting is not None and time.monotonic() - start_time > _LONGEST_WAIT
            if self._is_closed or is_late:
                raise _AbandonedError

        outcome: Frame | Exception
        try:
            outcome = (start and preview(configuration, start, check)) or solved(
                configuration, check
            )
        except Exception as error:
            # A plugin may raise anything, and the page has to go on.
            outcome = error
        if not self._is_closed:
            self._target.add_next_tick_callback(partial(self._receive, configuration, outcome))

    def _receive(self, configuration: Mapping[str, Any], outcome: Frame | Exception) -> None:
        """Show a frame or an error, and start the next solve if there is one."""
        self._is_working, is_finished = False, configuration is self._shown
        if isinstance(outcome, Frame):
            self.frame, self._shown = outcome, configuration
        try:
            if not isinstance(outcome, _AbandonedError):
                self._show(configuration, outcome)
        finally:
            if self._waiting is not None:
                self._start(self._waiting, self.frame)
            elif self.frame is not None and self.frame.is_preview and not is_finished:
                self._target.add_timeout_callback(partial(self._finish, self.frame), _REST)

    def _finish(self, preview: Frame) -> None:
        """Solve the run of a preview in full, if it is still shown.

        That need not be the last run requested: an impossible one leaves the frame before.
        """
        if preview is self.frame and self._shown is not None and not self._is_working:
            self._start(self._shown, None)
