"""Checks of a file of heights before it is read."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from pellicle import memory
from pellicle.errors import ConfigError
from pellicle.files import is_file
from pellicle.schema import fault_of_source

HDF5 = b"\x89HDF\r\n\x1a\n"
"""The first bytes of an HDF5 file."""


def require_file(path: Path) -> None:
    """Refuse a file that is missing or empty."""
    if not is_file(path):
        raise ConfigError(f"{path}: no such file; give the file that holds the heights", "path")
    if not path.stat().st_size:
        raise ConfigError(f"{path} is empty; give a file that holds a 2-D array", "path")


def require_memory(needed: float, subject: str) -> None:
    """Check that the available memory [bytes] suffices to read what a file holds."""
    memory.require_for(needed, subject, "export a part of it", "path")


def require_unpacked(path: Path) -> None:
    """Check that the memory suffices for all that an archive states that it unpacks to."""
    if zipfile.is_zipfile(path):
        # A damaged archive is left to the reader.
        with suppress(zipfile.BadZipFile), zipfile.ZipFile(path) as archive:
            # XML takes up to 48 times its size as objects.
            sizes = ((50.0 if "xml" in i.filename else 2.0) * i.file_size for i in archive.filelist)
            require_memory(sum(sizes), f"{path} with all that it unpacks to")


@contextmanager
def datasets(path: Path) -> Iterator[dict[str, Any]]:
    """Yield the datasets of an HDF5 file by name, each once, while it is open.

    Links out of the file are not followed, and a dataset with values from other files, which its
    hash does not cover, is refused.
    """
    import h5py

    items: dict[str, Any] = {}
    with h5py.File(path, "r") as file:
        file.visititems(lambda name, item: items.update({name: item}))
        arrays = {name: item for name, item in items.items() if isinstance(item, h5py.Dataset)}
        for reason in filter(None, map(fault_of_source, arrays.values())):
            raise ConfigError(f"{path} {reason}", "path")
        yield arrays
