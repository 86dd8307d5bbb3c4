"""One process at a time in the folder of a study."""

from __future__ import annotations

import json
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

import filelock

from .errors import StorageError
from .storage import reported


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Hold ``folder``; its file ``study.lock`` says who does.

    The lock itself is the operating system's, on a second file, and so ends with the process.

    Raises
    ------
    StorageError
        Another process holds it, or the folder cannot be written.
    """
    sign = folder / "study.lock"
    lock = filelock.FileLock(folder / ".study.lock")
    with reported(sign):
        folder.mkdir(parents=True, exist_ok=True)
        try:
            lock.acquire(timeout=0)
        except filelock.Timeout:
            raise StorageError(
                f"{folder} is at work: {_holder(sign)} holds it; wait until it has finished, or "
                "choose another folder (-o DIR)"
            ) from None
    try:
        with reported(sign):
            sign.write_text(
                json.dumps(
                    {
                        "host": socket.gethostname(),
                        "pid": os.getpid(),
                        "since": datetime.now(UTC).isoformat(timespec="seconds"),
                    }
                ),
                encoding="utf-8",
            )
        yield
    finally:
        sign.unlink(missing_ok=True)
        lock.release()


def _holder(sign: Path) -> str:
    try:
        said = json.loads(sign.read_text(encoding="utf-8"))
        return f"process {said['pid']} on {said['host']}, since {said['since']},"
    # It may be just being written.
    except (OSError, ValueError, LookupError):
        return "another process"
