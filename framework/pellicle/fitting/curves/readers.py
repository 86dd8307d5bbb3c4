"""Reads the measured curves of a file: named columns with units, or the format of an instrument."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from pellicle.errors import ConfigError, PellicleError, StorageError, shown
from pellicle.files import read_text

from . import afm
from .columns import EXAMPLE, NAMES, Calibration, Column, Measured, from_columns, is_curve

_HEADER = re.compile(r"([^\[(]*)(?:[\[(]([^\])]*)[\])])?")
_HDF5 = (".h5", ".hdf5", ".nc")
SUFFIXES = (".csv", ".tsv", ".txt", *_HDF5, *afm.SUFFIXES)
"""Endings of the files of a folder that are curves."""
_LABEL = "curve"
_FILE = "file"
_MANY = 8

Columns = Mapping[str, Column]
Found = dict[str, Measured | PellicleError]
"""What a file holds, by its label in the file: a curve, or what is wrong with it."""


def read(path: Path, calibration: Calibration | None = None, segment: str = "approach") -> Found:
    """Return the curves of a file, by their labels; that of an only curve is empty.

    A table (CSV, TSV, semicolons) has a header such as ``position [um],force [nN]``; cells that
    hold no number are NaN, columns of other names are ignored, and rows that differ in a column
    ``curve`` are different curves.  An HDF5 file has datasets of the same names with an attribute
    ``units``, or groups of them, one for each curve; a pellicle result is such a file.  Anything
    else is read by afmformats, which then picks the ``segment``.

    Raises
    ------
    ConfigError
        A column or a unit is missing, measures something else, or is there twice.
    StorageError
        The file cannot be read.
    """
    calibration = calibration or Calibration()
    if path.suffix.lower() in afm.SUFFIXES:
        return afm.read(path, calibration, segment)
    found = _hdf5(path) if path.suffix.lower() in _HDF5 else _table(path)
    hint = ""
    if not any(map(is_curve, found.values())):
        try:
            return afm.read(path, calibration, segment)
        except StorageError:
            # Not the format of an instrument either, or nobody can tell.
            hint = "" if afm.installed() else f"; if it is of an instrument: {afm.INSTALL}"
            if found and path.suffix.lower() not in _HDF5:
                hint = f"; its first line has {_first_cells(path)}{hint}"
    if not found:
        raise StorageError(
            f"{path}: is neither text, nor HDF5, nor of an instrument that can be read{hint}; "
            f"export it as a table with a header such as {EXAMPLE!r}"
        )
    curves: Found = {}
    for label, columns in found.items():
        try:
            curves[label] = from_columns(columns, calibration)
        except ConfigError as error:
            where = f"{path}: curve {label}" if label else str(path)
            curves[label] = ConfigError(f"{where}: {error}{hint}")
    return curves


def manifest(path: Path) -> list[dict[str, str]] | None:
    """Return the rows of a table that lists files, values with their units; None for any other.

    Its header is such as ``file,radius [um]``; a row has what is not empty.

    Raises
    ------
    StorageError
        The file cannot be read.
    """
    if path.suffix.lower() not in (".csv", ".tsv", ".txt") or (made := _cells(path)) is None:
        return None
    heads, rows, _ = made
    if _FILE not in [name for name, _ in heads]:
        return None
    return [
        {
            name: f"{cell.strip()} {unit}".strip()
            for (name, unit), cell in zip(heads, row, strict=False)
            if cell.strip()
        }
        for row in rows
    ]


def _table(path: Path) -> dict[str, Columns]:
    """Return the known columns of each curve of a table; none at all if it is no text."""
    made = _cells(path)
    if made is None:
        return {}
    heads, rows, number = made
    names = [name for name, _ in heads]
    places = {name: index for index, name in enumerate(names) if name in NAMES}
    for name in places:
        if names.count(name) > 1:
            raise ConfigError(
                f"{path}: has several columns {name}: give one curve to a file, tell curves apart "
                f"by a column {_LABEL}, or name the others differently"
            )
    curves: dict[str, list[list[str]]] = {"": rows}
    if _LABEL in names and places:
        curves = {}
        label = names.index(_LABEL)
        for row in rows:
            curves.setdefault(row[label].strip() if label < len(row) else "", []).append(row)
    return {
        label: {
            name: Column(heads[index][1], np.array([number(row, index) for row in own]))
            for name, index in places.items()
        }
        for label, own in curves.items()
    }


def _first_cells(path: Path) -> str:
    heads, _, _ = _cells(path) or ([], [], None)
    return ", ".join(shown(name) for name, _ in heads[:_MANY])


Number = Callable[[list[str], int], float]


def _cells(path: Path) -> tuple[list[tuple[str, str]], list[list[str]], Number] | None:
    """Return name and unit of each column, the rows below, and how numbers are read."""
    try:
        text = read_text(path)
    except OSError as error:
        raise StorageError(f"{path}: cannot be read ({error.strerror or error})") from None
    except ValueError:
        return None
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if not lines:
        raise ConfigError(f"{path}: is empty; give a table with the header {EXAMPLE!r}")
    separator = max("\t;,", key=lines[0].count)
    try:
        first, *rows = csv.reader(lines, delimiter=separator)
    except csv.Error:
        # A cell longer than any number.
        return None
    # Where semicolons separate, commas are decimal.
    comma = separator == ";"

    def number(row: list[str], index: int) -> float:
        try:
            return float(row[index].replace(",", ".") if comma else row[index])
        except (ValueError, IndexError):
            return float("nan")

    return [_head(head) for head in first], rows, number


def _head(text: str) -> tuple[str, str]:
    match = _HEADER.fullmatch(text.strip())
    if match is None:
        return text.lower(), ""
    return match[1].rstrip().lower(), (match[2] or "").strip()


def _hdf5(path: Path) -> dict[str, Columns]:
    import h5py

    try:
        with h5py.File(path) as file:
            if own := _datasets(file):
                return {"": own}
            groups = {
                str(name): _datasets(group)
                for name, group in file.items()
                if isinstance(group, h5py.Group)
            }
    except OSError as error:
        raise StorageError(
            f"{path}: cannot be read as an HDF5 file ({error.strerror or error})"
        ) from None
    return {name: columns for name, columns in groups.items() if columns} or {"": {}}


def _datasets(group: object) -> dict[str, Column]:
    """Return the known columns that are datasets of a group."""
    import h5py

    columns = {}
    for name in NAMES:
        found = group.get(name)  # type: ignore[attr-defined]
        if isinstance(found, h5py.Dataset) and found.ndim == 1:
            unit = found.attrs.get("units", "")
            unit = unit.decode() if isinstance(unit, bytes) else str(unit)
            columns[name] = Column(unit, np.asarray(found, dtype=float))
    return columns
