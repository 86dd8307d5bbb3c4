"""Measured curves from folders, files and lists of files."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.errors import ConfigError, PellicleError, StorageError, shown
from pellicle.files import read_text

from . import afm
from .columns import EXAMPLE, NAMES, Calibration, Column, from_columns, is_curve
from .curve import Curve

if TYPE_CHECKING:
    import h5py

_HEADER = re.compile(r"([^\[(]*)(?:[\[(]([^\])]*)[\])])?")
_TEXT = (".csv", ".tsv", ".txt")
_HDF5 = (".h5", ".hdf5", ".nc")
SUFFIXES = (*_TEXT, *_HDF5, *afm.SUFFIXES)
"""Suffixes of the files of a folder that are read."""
_PATTERN = re.compile(r"[*?[]")
_LABEL = "curve"
_FILE = "file"
_MANY = 8

Curves = str | Path | Sequence[str | Path] | Mapping[str, tuple[ArrayLike, ArrayLike]]
"""A folder, a file, a table that lists files, several of these; or position and force by name."""


class Source(NamedTuple):
    """One curve with its name, or the error of reading it."""

    name: str
    """File, and label in the file."""
    curve: Curve | PellicleError
    fields: Mapping[str, Any]
    """Fields of the indenter that this curve alone has."""

    def reason(self, error: Exception) -> str:
        """Return the message of an error without the name of the source in front."""
        return str(error).removeprefix(f"{self.name}: ")

    def named(self, error: ConfigError, hint: str = "") -> ConfigError:
        """Return an error with the name of the source in front and a hint at the end."""
        return ConfigError(f"{self.name}: {self.reason(error)}{hint}")


def gather(
    curves: Curves, segment: str, calibration: Calibration, per_file: Mapping[str, Sequence[Any]]
) -> list[Source]:
    """Return all curves, in order.

    Each list in ``per_file`` has one value for each file (or for each curve that is given by its
    numbers); spring_constant and sensitivity among them, and in a table that lists files, replace
    those of the calibration.

    Raises
    ------
    ConfigError
        There is no curve, or a list of values does not have one for each file.
    StorageError
        A folder or a list of files cannot be read.
    """
    if isinstance(curves, Mapping):
        files: list[tuple[Any, dict[str, Any]]] = [(name, {}) for name in curves]
    else:
        paths = [curves] if isinstance(curves, (str, Path)) else curves
        files = [file for text in paths for path in expanded(text) for file in _files(path)]
    if not files:
        raise ConfigError("holds no curve; give files, or a folder of them", "curves")
    sources = []
    for (file, listed), values in zip(files, fields_of_files(per_file, len(files)), strict=True):
        fields = values | listed
        settings = {name: fields.pop(name) for name in Calibration.model_fields if name in fields}
        try:
            own = Calibration(**calibration.model_dump() | settings)
            if isinstance(curves, Mapping):
                position, force = curves[file]
                # `clean` checks the arrays.
                contents: dict[str, Curve | PellicleError] = {
                    "": Curve(
                        cast("Array", position), cast("Array", force), stiffness=own.spring_constant
                    )
                }
            else:
                contents = read(file, own, segment)
        except PellicleError as error:
            contents = {"": error}
        for label, curve in contents.items():
            sources.append(Source(f"{file}:{label}" if label else str(file), curve, fields))
    return sources


def fields_of_files(per_file: Mapping[str, Sequence[Any]], count: int) -> list[dict[str, Any]]:
    """Return the fields of each file."""
    for name, values in per_file.items():
        if len(values) != count:
            raise ConfigError(
                f"{len(values)} values for {count} files; give one, or one for each file in order",
                name,
            )
    return [{name: values[n] for name, values in per_file.items()} for n in range(count)]


def expanded(pattern: str | Path, folder: str | Path = "") -> list[Path]:
    """Return the files that match a pattern such as ``"beads/*.csv"``; any other path as it is."""
    path = Path(folder, pattern)
    if path.exists() or not _PATTERN.search(str(pattern)):
        return [path]
    anchor, files = Path(pattern).anchor, []
    # Before Python 3.13, a pattern such as "**.csv" is a ValueError.
    with suppress(ValueError):
        files = sorted(Path(anchor or folder).glob(str(Path(pattern).relative_to(anchor))))
    if not files:
        raise ConfigError(f"{pattern}: matches no file; give files, or a folder of them", "curves")
    return files


def _files(path: Path) -> list[tuple[Path, dict[str, str]]]:
    """Return the files that a path stands for, each with its fields in a list of files."""
    if path.is_dir():
        files = sorted(
            file
            for file in path.iterdir()
            if file.suffix.lower() in SUFFIXES and not file.name.startswith(".")
        )
        if not files:
            raise ConfigError(f"{path}: holds no file of a known kind ({', '.join(SUFFIXES)})")
        return [(file, {}) for file in files]
    if not path.is_file() or (rows := manifest(path)) is None:
        return [(path, {})]
    if not all(_FILE in row for row in rows):
        raise ConfigError(f"{path}: has a row without a file; name one in each row")
    return [(path.parent / row.pop(_FILE), row) for row in rows]


def read(
    path: Path, calibration: Calibration | None = None, segment: str = "approach"
) -> dict[str, Curve | PellicleError]:
    """Return the curves of a file, or the errors of reading them, by their labels.

    The label of a single curve is empty.  A table (CSV, TSV, semicolons) has a header such as
    ``position [um],force [nN]``; cells that hold no number are NaN, columns of other names are
    ignored, and rows that differ in a column ``curve`` are different curves.  An HDF5 file has
    datasets of the same names with an attribute ``units``, or groups of them, one for each curve; a
    pellicle result is such a file.  Any other file is read by afmformats, which then selects the
    ``segment``.

    Raises
    ------
    ConfigError
        A column or a unit is missing, measures something else, or a column is repeated.
    StorageError
        The file cannot be read.
    """
    calibration, suffix = calibration or Calibration(), path.suffix.lower()
    if suffix in afm.SUFFIXES:
        return afm.read(path, calibration, segment)
    tables = _hdf5(path) if suffix in _HDF5 else _table(path)
    hint = ""
    if not any(map(is_curve, tables.values())):
        try:
            return afm.read(path, calibration, segment)
        except StorageError:
            # Only afmformats can recognise the file of an instrument.
            hint = "" if afm.installed() else f"; if it is an instrument's: {afm.INSTALL}"
            if tables and suffix not in _HDF5:
                hint = f"; its first line is {_first_cells(path)}{hint}"
    if not tables:
        raise StorageError(
            f"{path}: is neither text, nor HDF5, nor a readable file of an instrument{hint}; "
            f"export it as a table with a header such as {EXAMPLE!r}"
        )
    curves: dict[str, Curve | PellicleError] = {}
    for label, columns in tables.items():
        try:
            curves[label] = from_columns(columns, calibration)
        except ConfigError as error:
            where = f"{path}: curve {label}" if label else str(path)
            curves[label] = ConfigError(f"{where}: {error}{hint}")
    return curves


def manifest(path: Path) -> list[dict[str, str]] | None:
    """Return the rows of a table that lists files, values with their units; None if it is not one.

    Its header is such as ``file,radius [um]``; empty cells are left out.
    """
    if path.suffix.lower() not in _TEXT or (cells := _cells(path)) is None:
        return None
    heads, rows, _ = cells
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


def _table(path: Path) -> dict[str, Mapping[str, Column]]:
    """Return the known columns of each curve of a table; nothing if the file is not text."""
    cells = _cells(path)
    if cells is None:
        return {}
    heads, rows, number = cells
    names = [name for name, _ in heads]
    indices = {name: index for index, name in enumerate(names) if name in NAMES}
    for name in indices:
        if names.count(name) > 1:
            raise ConfigError(
                f"{path}: has several columns {name}: give one curve to a file, tell curves apart "
                f"by a column {_LABEL}, or name the others differently"
            )
    curves: dict[str, list[list[str]]] = {"": rows}
    if _LABEL in names and indices:
        curves = {}
        label = names.index(_LABEL)
        for row in rows:
            curves.setdefault(row[label].strip() if label < len(row) else "", []).append(row)
    return {
        label: {
            name: Column(heads[index][1], np.array([number(row, index) for row in own]))
            for name, index in indices.items()
        }
        for label, own in curves.items()
    }


def _first_cells(path: Path) -> str:
    heads, _, _ = _cells(path) or ([], [], None)
    return ", ".join(shown(name) for name, _ in heads[:_MANY])


Number = Callable[[list[str], int], float]


def _cells(path: Path) -> tuple[list[tuple[str, str]], list[list[str]], Number] | None:
    """Return name and unit of each column, the rows below, and the reader of numbers."""
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
        # A cell is longer than any number.
        return None
    # Tables separated by semicolons come from systems whose decimal separator is the comma.
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


def _hdf5(path: Path) -> dict[str, Mapping[str, Column]]:
    import h5py

    try:
        with h5py.File(path) as file:
            if columns := _datasets(file):
                return {"": columns}
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


def _datasets(group: h5py.Group) -> dict[str, Column]:
    """Return the known columns that are datasets of a group."""
    import h5py

    columns = {}
    for name in NAMES:
        dataset = group.get(name)
        if isinstance(dataset, h5py.Dataset) and dataset.ndim == 1:
            unit = dataset.attrs.get("units", "")
            unit = unit.decode() if isinstance(unit, bytes) else str(unit)
            columns[name] = Column(unit, np.asarray(dataset, dtype=float))
    return columns
