"""Reads a measured curve: columns with a name and a unit, from a table or an HDF5 file."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pellicle.errors import ConfigError, StorageError, shown
from pellicle.operators import Array
from pellicle.units import Quantity

_HEADER = re.compile(r"\s*([^\[(]*?)\s*(?:[\[(]([^\])]*)[\])])?\s*")
_UNITS = {"position": "m", "depth": "m", "force": "N"}
_EXAMPLE = "position [um],force [nN]"
_HDF5 = (".h5", ".hdf5", ".nc")


@dataclass(frozen=True)
class Measured:
    """Columns of a file in SI."""

    force: Array
    position: Array | None = None
    depth: Array | None = None


def read(path: Path) -> Measured:
    """Return position (or depth) and force of a file.

    A table (CSV, TSV, semicolons) has a header such as ``position [um],force [nN]``; other columns
    are ignored, and cells that hold no number are NaN.  In an HDF5 file the datasets ``position``
    or ``depth`` and ``force`` have an attribute ``units``; a pellicle result is such a file.

    Raises
    ------
    ConfigError
        A column or a unit is missing, measures something else, or is there twice.
    StorageError
        The file cannot be read.
    """
    columns = _hdf5(path) if path.suffix.lower() in _HDF5 else _table(path)
    if "force" not in columns:
        raise ConfigError(
            f"{path}: has no column force (columns: {', '.join(columns) or 'none'}); give a header "
            f"such as {_EXAMPLE!r}"
        )
    places = [name for name in ("position", "depth") if name in columns]
    if len(places) != 1:
        what = "both position and depth" if places else "no column position or depth"
        raise ConfigError(f"{path}: has {what}; give one of them, e.g. {_EXAMPLE!r}")
    values = {
        name: _factor(path, name, columns[name][0]) * columns[name][1]
        for name in (places[0], "force")
    }
    return Measured(**values)


def _factor(path: Path, name: str, unit: str) -> float:
    """Return what a column is to be multiplied by."""
    if not unit:
        raise ConfigError(
            f"{path}: column {name} has no unit; write it in the header, e.g. {_EXAMPLE!r}"
        )
    try:
        return Quantity(_UNITS[name])(f"1 {unit}")
    except ValueError:
        hint = (
            "; multiply volts by deflection sensitivity [m/V] and spring constant [N/m]"
            if unit in ("V", "mV", "volt", "volts")
            else ""
        )
        raise ConfigError(
            f"{path}: column {name} is in {shown(unit)}, which is no unit of {name}; give it in "
            f"{_UNITS[name]} or a multiple, e.g. {_EXAMPLE!r}{hint}"
        ) from None


def _table(path: Path) -> Mapping[str, tuple[str, Array]]:
    """Return unit and values of each known column."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise StorageError(f"{path}: cannot be read ({error.strerror or error})") from None
    except UnicodeDecodeError:
        raise StorageError(f"{path} is not a text file; give a CSV or an HDF5 file") from None
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if not lines:
        raise ConfigError(f"{path}: is empty; give a table with the header {_EXAMPLE!r}")
    separator = max("\t;,", key=lines[0].count)
    rows = list(csv.reader(lines, delimiter=separator))
    # Where semicolons separate, commas are decimal.
    comma = separator == ";"
    columns: dict[str, tuple[str, Array]] = {}
    for index, head in enumerate(rows[0]):
        match = _HEADER.fullmatch(head)
        name, unit = (match[1].lower(), match[2] or "") if match else (head.lower(), "")
        if name not in _UNITS:
            continue
        if name in columns:
            raise ConfigError(
                f"{path}: has several columns {name}: give one curve to a file, or name the others "
                "differently"
            )
        columns[name] = (unit, np.array([_number(row, index, comma) for row in rows[1:]]))
    return columns


def _number(row: list[str], index: int, comma: bool) -> float:
    try:
        return float(row[index].replace(",", ".") if comma else row[index])
    except (ValueError, IndexError):
        return float("nan")


def _hdf5(path: Path) -> Mapping[str, tuple[str, Array]]:
    import h5py

    columns: dict[str, tuple[str, Array]] = {}
    try:
        with h5py.File(path) as file:
            for name in _UNITS:
                found = file.get(name)
                if isinstance(found, h5py.Dataset) and found.ndim == 1:
                    unit = found.attrs.get("units", "")
                    unit = unit.decode() if isinstance(unit, bytes) else str(unit)
                    columns[name] = (unit, np.asarray(found, dtype=float))
    except OSError as error:
        raise StorageError(
            f"{path}: cannot be read as an HDF5 file ({error.strerror or error})"
        ) from None
    return columns
