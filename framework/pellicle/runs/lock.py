"""A lock that lets one process at a time write the files of a run or a study."""

from __future__ import annotations

import json
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path

import filelock

from pellicle.errors import StorageError
from pellicle.files import storage_errors


@contextmanager
def locked(folder: Path, name: str) -> Iterator[None]:
    """Lock the files in ``folder`` that begin with ``name``; ``name.lock`` names the process.

    The lock itself is one of the operating system, on a second file, so it ends with the process.
    Both files are removed at the end.
    """
    sign = folder / f"{name}.lock"
    lock = filelock.FileLock(folder / f".{name}.lock")
    with storage_errors(sign):
        folder.mkdir(parents=True, exist_ok=True)
        try:
            lock.acquire(timeout=0)
        except filelock.Timeout:
            raise StorageError(
                f"{folder / name} is locked by {_holder(sign)}; wait until it has finished, or "
                "choose another folder (-o DIR)"
            ) from None
    try:
        with storage_errors(sign):
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
        # The file is removed before the lock is released: filelock does not acquire a lock on a
        # file without a name. Windows cannot remove an open file; there it remains.
        with suppress(PermissionError):
            Path(lock.lock_file).unlink(missing_ok=True)
        lock.release()


def _holder(sign: Path) -> str:
    try:
        holder = json.loads(sign.read_text(encoding="utf-8"))
        return f"process {holder['pid']} on {holder['host']}, since {holder['since']}"
    # Another process may be writing it at this moment.
    except (OSError, ValueError, LookupError, TypeError):
        return "another process"
