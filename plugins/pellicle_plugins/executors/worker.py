"""A process that executes tasks one by one for its parent process, and ends with it."""

from __future__ import annotations

import os
import pickle
import signal
import sys
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection
from queue import SimpleQueue
from typing import Any

import cloudpickle
import loky  # noqa: F401  (makes the start method "loky" known)

from pellicle import PellicleError

from .execution import execute_remotely

_MESSAGE, _OUTCOME = b"m", b"o"


class Worker:
    """A worker process, as its parent sees it.

    loky starts a new process instead of forking one that may have threads. It does not import the
    parent's ``__main__``, so neither a script without ``if __name__ == "__main__"`` nor a notebook
    is run again. cloudpickle sends their definitions by value.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        self.connection, theirs = get_context("loky").Pipe()
        self._process = get_context("loky").Process(  # type: ignore[attr-defined]
            target=_serve, args=(theirs,), daemon=True, env=dict(environment)
        )
        with theirs, _interrupts_blocked():
            self._process.start()

    def start(self, payload: bytes) -> None:
        """Send a packed task."""
        # If the worker has died in the meantime, `receive` returns its death as the outcome.
        with suppress(OSError):
            self.connection.send_bytes(payload)

    def receive(self) -> tuple[bool, Any]:
        """Return True and the outcome of the task, or False and a message of its work.

        Call this when `connection` is ready. The death of the worker is an outcome too.
        """
        try:
            message = self.connection.recv_bytes()
        except (EOFError, OSError):
            self._process.join()
            code = self._process.exitcode
            cause = f"exit code {code}" if code >= 0 else signal.Signals(-code).name
            if cause == "SIGKILL":
                cause += ", as when the system is out of memory"
            return True, PellicleError(f"its worker died: {cause}; the other runs go on")
        return message[:1] == _OUTCOME, pickle.loads(message[1:])

    @property
    def alive(self) -> bool:
        """Whether the process can take a task."""
        return bool(self._process.is_alive())

    def end(self) -> None:
        """Terminate the process and wait for its end."""
        self.connection.close()
        self._process.terminate()
        self._process.join()


@contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Block Ctrl-C within this context, and permanently in processes started within it."""
    if sys.platform == "win32":
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _serve(connection: Connection[Any, Any]) -> None:
    """Execute tasks until the parent terminates this process or dies."""
    # A terminal sends Ctrl-C to workers too, but the parent decides when they end.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    payloads: SimpleQueue[bytes] = SimpleQueue()
    threading.Thread(target=_listen, args=(connection, payloads), daemon=True).start()

    def say(message: Any) -> None:
        connection.send_bytes(_MESSAGE + cloudpickle.dumps(message))

    while True:
        connection.send_bytes(_OUTCOME + execute_remotely(payloads.get(), say))


def _listen(connection: Connection[Any, Any], payloads: SimpleQueue[bytes]) -> None:
    """Receive tasks; exit at once when the parent has died, even by SIGKILL."""
    try:
        while True:
            payloads.put(connection.recv_bytes())
    except (EOFError, OSError):
        os._exit(1)
