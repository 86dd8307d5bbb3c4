"""A lock that lets one process at a time write the files of a run or a study."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import filelock

from pellicle.errors import StorageError
from pellicle.files import storage_errors


class LockedError(StorageError):
    """Files that another process writes."""


@contextmanager
def lock_files(folder: Path, name: str, *, wait: bool = False) -> Iterator[None]:
    """Lock the files in ``folder`` that begin with ``name``; ``wait`` for another process or raise.

    The lock is one of the operating system, so it ends with the process; its file is removed.
    """
    lock = filelock.FileLock(folder / f".{name}.lock")
    with storage_errors(folder / name):
        folder.mkdir(parents=True, exist_ok=True)
        try:
            lock.acquire(timeout=-1 if wait else 0)
        except filelock.Timeout:
            raise LockedError(
                f"{folder / name} is locked by another process; wait until it has finished, or "
                "choose another folder (-o DIR)"
            ) from None
    try:
        yield
    finally:
        # The file is removed before the lock is released: filelock does not acquire a lock on a
        # file without a name. Windows cannot remove an open file; there it remains.
        with suppress(PermissionError):
            Path(lock.lock_file).unlink(missing_ok=True)
        lock.release()
