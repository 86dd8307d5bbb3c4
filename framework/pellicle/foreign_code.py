"""Guards for the code of plugins: against writing to standard output and raising KeyboardInterrupt.

Commands print JSON to standard output, which a single line from a plugin would make invalid.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import StringIO
from types import FrameType
from typing import TextIO

from .errors import PluginError

# File descriptors, which C libraries and subprocesses write to directly.
_OUT, _ERR = 1, 2
# Standard output belongs to the process: of two threads that redirect it at the same time the
# second would restore what the first has redirected. A plugin may load another one.
_diverting = threading.RLock()


@contextmanager
def diverted_output() -> Iterator[None]:
    """Redirect standard output to standard error, in one thread at a time.

    Raises
    ------
    PluginError
        The code closed standard output; it has been reopened.
    """
    with _diverting, _diverted():
        yield


@contextmanager
def _diverted() -> Iterator[None]:
    stream = sys.stdout
    was_closed = _is_closed(stream)
    _flush(stream, sys.__stdout__)
    sys.stdout = stand_in = _stand_in()
    descriptor = _divert_descriptor()
    try:
        yield
    finally:
        _flush(sys.stdout, stand_in, stream, sys.__stdout__)
        is_closed = stand_in.closed or (descriptor is not None and not _same_file(_OUT, _ERR))
        if descriptor is not None:
            os.dup2(descriptor, _OUT)
            os.close(descriptor)
        sys.stdout = stream
        if _is_closed(stream) and not was_closed:
            is_closed = True
            sys.stdout = open(  # noqa: SIM115 - for the rest of the process
                _OUT, "w", encoding=stream.encoding, errors=stream.errors, closefd=False
            )
    if is_closed:
        raise PluginError("closes standard output; leave it open")


@contextmanager
def noted_interrupts() -> Iterator[threading.Event]:
    """Yield an event that is set when the user presses Ctrl-C, even if the exception is caught.

    The previous handler is restored. Only the main thread receives Ctrl-C.
    """
    interrupt = threading.Event()
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield interrupt
        return

    def handle(number: int, frame: FrameType | None) -> None:
        interrupt.set()
        before(number, frame)

    signal.signal(signal.SIGINT, handle)
    try:
        yield interrupt
    finally:
        signal.signal(signal.SIGINT, before)


def _stand_in() -> TextIO:
    """Return a stream to standard error that may be closed without closing standard error."""
    encoding = getattr(sys.stderr, "encoding", None) or "utf-8"
    try:
        return open(
            _ERR, "w", buffering=1, encoding=encoding, errors="backslashreplace", closefd=False
        )
    except OSError:
        return StringIO()


def _divert_descriptor() -> int | None:
    """Point the descriptor of standard output to standard error; return a copy of the old one."""
    try:
        copy = os.dup(_OUT)
    except OSError:
        return None
    try:
        os.dup2(_ERR, _OUT)
    except OSError:
        os.close(copy)
        return None
    return copy


def _same_file(first: int, second: int) -> bool:
    try:
        return os.path.sameopenfile(first, second)
    except OSError:
        return False


def _is_closed(stream: TextIO | None) -> bool:
    return stream is None or stream.closed


def _flush(*streams: TextIO | None) -> None:
    for stream in streams:
        with suppress(OSError, ValueError):
            if stream is not None:
                stream.flush()
    # C libraries buffer their output themselves.
    with suppress(OSError, AttributeError, TypeError):
        ctypes.CDLL(None).fflush(None)
