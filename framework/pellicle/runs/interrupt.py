"""Ctrl-C while a run is being solved."""

from __future__ import annotations

import signal
import threading


class Interrupt:
    """Defers the first Ctrl-C to the next `check`; the second acts at once.

    An exception raised at an arbitrary point could be lost: Python drops exceptions in finalisers,
    and every h5py object has one.
    """

    def __init__(self) -> None:
        self._holds = self._pressed = False

    def hold(self) -> None:
        """Take over Ctrl-C, if nobody else has and this is the main thread."""
        is_main = threading.current_thread() is threading.main_thread()
        if is_main and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, self._press)
            self._holds = True

    def release(self) -> None:
        """Give Ctrl-C back to Python."""
        if self._holds:
            signal.signal(signal.SIGINT, signal.default_int_handler)
            self._holds = False

    def _press(self, *_: object) -> None:
        self.release()
        self._pressed = True

    def check(self) -> None:
        """Raise KeyboardInterrupt if Ctrl-C has been pressed since the last check."""
        if self._pressed:
            self._pressed = False
            raise KeyboardInterrupt
