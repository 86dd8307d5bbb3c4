"""A process that carries out one task after the other for its parent, and ends with it."""

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

from .execution import attempt_far

_SAID, _OUTCOME = b"s", b"o"


class Worker:
    """The parent's side of a process.

    loky starts it: afresh, not as a copy of a process that may have threads, and without importing
    the parent's ``__main__``, so that neither a script without ``if __name__ == "__main__"`` nor a
    notebook is carried out once more. What they define travels by value, with cloudpickle.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        self.connection, theirs = get_context("loky").Pipe()
        self._process = get_context("loky").Process(  # type: ignore[attr-defined]
            target=_serve, args=(theirs,), daemon=True, env=dict(environment)
        )
        with theirs, _interruptions_held():
            self._process.start()

    def begin(self, parcel: bytes) -> None:
        """Hand over a packed task."""
        # Where it died in the meantime, `receive` says so.
        with suppress(OSError):
            self.connection.send_bytes(parcel)

    def receive(self) -> tuple[bool, Any]:
        """Return whether this is the outcome of the task, and it, or else what its work said.

        To be called where `connection` is ready. A worker that died leaves an outcome too.
        """
        try:
            message = self.connection.recv_bytes()
        except (EOFError, OSError):
            self._process.join()
            cause = _cause(self._process.exitcode)
            return True, PellicleError(f"its worker died: {cause}; the other runs go on")
        return message[:1] == _OUTCOME, pickle.loads(message[1:])

    @property
    def alive(self) -> bool:
        """Whether it can take a task."""
        return bool(self._process.is_alive())

    def end(self) -> None:
        """End the process, whatever it is doing, and wait until it is gone."""
        self.connection.close()
        self._process.terminate()
        self._process.join()


def _cause(code: int) -> str:
    if code >= 0:
        return f"exit code {code}"
    name = signal.Signals(-code).name
    return f"{name}, as when the system is out of memory" if name == "SIGKILL" else name


@contextmanager
def _interruptions_held() -> Iterator[None]:
    """Hold Ctrl-C back here, and for good in a process that is started meanwhile."""
    if sys.platform == "win32":
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _serve(connection: Connection[Any, Any]) -> None:
    """Carry out tasks until the parent ends this process, or ends itself."""
    # A terminal sends Ctrl-C to workers too; what becomes of them is for the parent to say.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parcels: SimpleQueue[bytes] = SimpleQueue()
    threading.Thread(target=_listen, args=(connection, parcels), daemon=True).start()

    def say(said: Any) -> None:
        connection.send_bytes(_SAID + cloudpickle.dumps(said))

    while True:
        connection.send_bytes(_OUTCOME + attempt_far(parcels.get(), say))


def _listen(connection: Connection[Any, Any], parcels: SimpleQueue[bytes]) -> None:
    """Take tasks in; where the parent is gone, even by SIGKILL, go too, in mid-task."""
    try:
        while True:
            parcels.put(connection.recv_bytes())
    except (EOFError, OSError):
        os._exit(1)
