"""Measured curves of one file, by the installed reader of its kind."""

from __future__ import annotations

import os
from contextlib import suppress
from fnmatch import fnmatchcase
from pathlib import Path

from pellicle import registry
from pellicle.errors import ConfigError, StorageError
from pellicle.files import is_file, is_folder

from .columns import Calibration
from .measurement import CurvesByLabel
from .reader import Reader

TEXT = (".csv", ".tsv", ".txt")
"""Suffixes of tables."""
_TABLE = "table"
"""Type of the reader of files of unknown suffixes."""


def suffixes() -> tuple[str, ...]:
    """Return the suffixes of the files of a folder that are read."""
    return tuple(sorted({suffix for reader in _readers() for suffix in reader.suffixes}))


def read(path: Path, calibration: Calibration | None = None) -> CurvesByLabel:
    """Return functions that read the curves of a file, and raise what this one does.

    The columns of the calibration name those of a table, and the arrays of an HDF5 or MATLAB file.
    """
    known_calibration = calibration or Calibration()
    if os.path.exists(path) and not (is_file(path) or is_folder(path)):
        raise StorageError(f"{path}: is a pipe or a device; give a file")
    makers, others = _of_suffix(path)
    maker = None if known_calibration.columns and others else _sniffed(path, makers, others)
    if maker and known_calibration.columns:
        raise ConfigError(f"{path} states what its columns are; leave columns out", "columns")
    if maker:
        return maker.read(path, known_calibration)
    table = registry().make(Reader, {"type": _TABLE})
    if others or not makers or not is_file(path):
        return (others or [table])[0].read(path, known_calibration)
    with suppress(StorageError):
        return table.read(path, known_calibration)
    kinds = " or ".join(reader.type_name for reader in makers)
    raise StorageError(f"{path}: has the suffix of force curves ({kinds}), and holds none")


def has_known_suffix(path: Path) -> bool:
    """Return whether a file has the suffix of one with curves."""
    return any(fnmatchcase(path.suffix.lower(), pattern) for pattern in suffixes())


def is_read(path: Path) -> bool:
    """Return whether a file of a folder is taken for one with curves."""
    makers, others = _of_suffix(path)
    return bool(others or _sniffed(path, makers, others))


def _of_suffix(path: Path) -> tuple[list[Reader], list[Reader]]:
    """Return the readers of a suffix, strangers' first, and those whose columns can be named."""
    suffix = path.suffix.lower()
    readers = [r for r in _readers() if any(fnmatchcase(suffix, like) for like in r.suffixes)]
    makers = [reader for reader in readers if not reader.takes_columns]
    return makers, [reader for reader in readers if reader.takes_columns]


def _readers() -> list[Reader]:
    """Return a reader of each kind of file, strangers' first."""
    entries = registry().components[Reader.family].values()
    ordered = sorted(entries, key=lambda entry: entry.origin.is_built_in)
    return [registry().make(Reader, {"type": entry.type}) for entry in ordered]


def _sniffed(path: Path, makers: list[Reader], others: list[Reader]) -> Reader | None:
    """Return the reader of a file of an instrument, unless it is a table with known columns."""
    for maker in makers:
        with suppress(OSError):
            if maker.sniff(path):
                is_known = path.suffix.lower() in TEXT and any(r.sniff(path) for r in others)
                return None if is_known else maker
    return None
