"""Measured curves from folders, files and lists of files."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.errors import ConfigError, PellicleError, StorageError, shown
from pellicle.files import read_text

from . import afm
from .columns import EXAMPLE, NAMES, Calibration, Channel, from_columns, is_curve
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
    arrays = curves if isinstance(curves, Mapping) else {}
    if isinstance(curves, Mapping):
        files: list[tuple[Any, dict[str, str]]] = [(name, {}) for name in curves]
    else:
        paths = [curves] if isinstance(curves, (str, Path)) else curves
        files = [file for text in paths for path in expanded(text) for file in _files(path)]
    if not files:
        raise ConfigError("holds no curve; give files, or a folder of them", "curves")
    for name, values in per_file.items():
        if len(values) != len(files):
            raise ConfigError(
                f"{len(values)} values for {len(files)} files; give one, or one for each file in "
                "order",
                name,
            )
    sources = []
    for number, (file, listed) in enumerate(files):
        fields = {name: values[number] for name, values in per_file.items()} | listed
        names = Calibration.model_fields
        settings = {name: getattr(calibration, name) for name in names}
        settings |= {name: fields.pop(name) for name in names if name in fields}
        contents: Mapping[str, Curve | PellicleError]
        try:
            own = Calibration(**settings)
            if file in arrays:
                # `clean` checks the arrays.
                position, force = (cast("Array", values) for values in arrays[file])
                given = Curve(position, force, stiffness=own.spring_constant, speed=own.speed)
                contents = {"": given}
            else:
                contents = read(file, own, segment)
        except PellicleError as error:
            contents = {"": error}
        for label, curve in contents.items():
            sources.append(Source(f"{file}:{label}" if label else str(file), curve, fields))
    return sources


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
    """Return the files that a path stands for, each with its fields in a list of files.

    A list of files is a table with a header such as ``file,radius [um]``; its values get their
    units, and empty cells are left out.
    """
    if path.is_dir():
        files = sorted(
            file
            for file in path.iterdir()
            if file.suffix.lower() in SUFFIXES and not file.name.startswith(".")
        )
        if not files:
            raise ConfigError(f"{path}: holds no file of a known kind ({', '.join(SUFFIXES)})")
        return [(file, {}) for file in files]
    cells = _cells(path) if path.suffix.lower() in _TEXT and path.is_file() else None
    if cells is None or _FILE not in [name for name, _ in cells.heads]:
        return [(path, {})]
    listed = []
    for row in cells.rows:
        fields = {
            name: f"{cell.strip()} {unit}".strip()
            for (name, unit), cell in zip(cells.heads, row, strict=False)
            if cell.strip()
        }
        if _FILE not in fields:
            raise ConfigError(f"{path}: has a row without a file; name one in each row")
        listed.append((path.parent / fields.pop(_FILE), fields))
    return listed


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
    cells = None if suffix in _HDF5 else _cells(path)
    tables = _hdf5(path) if suffix in _HDF5 else _table(path, cells) if cells else {}
    hint = ""
    if not any(map(is_curve, tables.values())):
        try:
            return afm.read(path, calibration, segment)
        except StorageError:
            # Only afmformats can recognise the file of an instrument.
            hint = "" if afm.installed() else f"; if it is an instrument's: {afm.INSTALL}"
            if cells is not None:
                first = ", ".join(shown(name) for name, _ in cells.heads[:_MANY])
                hint = f"; its first line is {first}{hint}"
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


class _Cells(NamedTuple):
    """The cells of a table as texts."""

    heads: list[tuple[str, str]]
    """Name and unit of each column."""
    rows: list[list[str]]
    comma: bool
    """Whether the decimal separator is a comma."""

    def numbers(self, rows: list[list[str]], index: int) -> Array:
        """Return a column of some rows; NaN where a cell is missing or holds no number."""
        values = np.full(len(rows), np.nan)
        for number, row in enumerate(rows):
            with suppress(ValueError, IndexError):
                values[number] = float(row[index].replace(",", ".") if self.comma else row[index])
        return values


def _cells(path: Path) -> _Cells | None:
    """Return the cells of a table; None if the file is not text."""
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
    heads = []
    for head in first:
        match = _HEADER.fullmatch(head.strip())
        name, unit = match.groups(default="") if match else (head, "")
        heads.append((name.rstrip().lower() if match else head.lower(), unit.strip()))
    # Tables separated by semicolons come from systems whose decimal separator is the comma.
    return _Cells(heads, rows, separator == ";")


def _table(path: Path, cells: _Cells) -> dict[str, Mapping[str, Channel]]:
    """Return the known columns of each curve of a table."""
    names = [name for name, _ in cells.heads]
    indices = {name: index for index, name in enumerate(names) if name in NAMES}
    for name in indices:
        if names.count(name) > 1:
            raise ConfigError(
                f"{path}: has several columns {name}: give one curve to a file, tell curves apart "
                f"by a column {_LABEL}, or name the others differently"
            )
    curves: dict[str, list[list[str]]] = {"": cells.rows}
    if _LABEL in names and indices:
        curves = {}
        label = names.index(_LABEL)
        for row in cells.rows:
            curves.setdefault(row[label].strip() if label < len(row) else "", []).append(row)
    return {
        label: {
            name: Channel(cells.heads[index][1], cells.numbers(rows, index))
            for name, index in indices.items()
        }
        for label, rows in curves.items()
    }


def _hdf5(path: Path) -> dict[str, Mapping[str, Channel]]:
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


def _datasets(group: h5py.Group) -> dict[str, Channel]:
    """Return the known columns that are datasets of a group."""
    import h5py

    columns = {}
    for name in NAMES:
        dataset = group.get(name)
        if isinstance(dataset, h5py.Dataset) and dataset.ndim == 1:
            unit = dataset.attrs.get("units", "")
            unit = unit.decode() if isinstance(unit, bytes) else str(unit)
            columns[name] = Channel(unit, np.asarray(dataset, dtype=float))
    return columns
