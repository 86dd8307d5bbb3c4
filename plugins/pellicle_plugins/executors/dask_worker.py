"""One task on a dask worker."""

from __future__ import annotations

import ctypes
import pickle
import time
from concurrent.futures import CancelledError
from contextlib import suppress
from importlib.metadata import version
from typing import Any

import cloudpickle
from distributed import get_worker

from pellicle import PellicleError
from pellicle.batch import LockedError

from .execution import execute_remotely

_KEPT = {-1: 2**30, -3: 2**25}
"""Options of mallopt of glibc: freed bytes that are kept, bytes of an array of its own."""
_RUNNING = "running", "paused"
_LOCK_TIMEOUT, _LOCK_INTERVAL = 60.0, 1.0
"""Largest time for which files of a task stay locked by a worker that had it before [s]."""


def execute_on_worker(
    payload: bytes, our_version: str, topic: str, index: int, begun: bool
) -> bytes:
    """Return the pickled outcome of a packed task, which another worker may have ``begun``."""
    if (installed := version("pellicle")) != our_version:
        error = f"the worker has pellicle {installed}, not {our_version} as here; install the same"
        return pickle.dumps(PellicleError(error))
    # dask has freed memory given back at once, which makes a solve take twice as long.
    with suppress(AttributeError, OSError, TypeError):
        for option, value in _KEPT.items():
            ctypes.CDLL(None).mallopt(option, value)
    worker = get_worker()
    key = worker.get_current_task()

    def require_wanted() -> None:
        # dask cannot stop a running task. It changes the state of one whose result is not needed,
        # but not of one that it takes from a worker that ends.
        task = worker.state.tasks.get(key)
        if task is None or task.state != "executing" or worker.status.name not in _RUNNING:
            raise CancelledError(f"{key} was withdrawn")

    def say(message: Any) -> None:
        require_wanted()
        worker.log_event(topic, (index, cloudpickle.dumps(message)))

    end = time.monotonic() + _LOCK_TIMEOUT * begun
    while True:
        outcome = execute_remotely(payload, say)
        if time.monotonic() >= end or not isinstance(pickle.loads(outcome), LockedError):
            return outcome
        time.sleep(_LOCK_INTERVAL)
        require_wanted()
