"""Measured curves from folders, files and lists of files."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple, cast

from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.errors import ConfigError, PellicleError, StorageError, shown

from . import afm
from .columns import Calibration, from_columns, is_curve
from .curve import Curve
from .origin import Stamped, state
from .roles import EXAMPLE
from .text_table import FILE, curves_of, read_cells
from .tree import read_hdf5, read_matlab

_TEXT = (".csv", ".tsv", ".txt")
_HDF5 = (".h5", ".hdf5", ".nc")
_MATLAB = (".mat",)
SUFFIXES = (*_TEXT, *_HDF5, *_MATLAB, *afm.SUFFIXES)
"""Suffixes of the files of a folder that are read."""
_PATTERN = re.compile(r"[*?[]")
_MANY = 8
_TABLES_TOO = (".tab",)
"""Suffixes of instrument files that are tables."""
_SPREADSHEETS = (".xlsx", ".xlsm", ".xls", ".ods", ".numbers")

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
    cells = read_cells(path) if path.suffix.lower() in _TEXT and path.is_file() else None
    if cells is None or FILE not in cells.names:
        return [(path, {})]
    listed = []
    for row in cells.rows:
        fields = {
            head.name.lower(): f"{cell.strip()} {head.unit}".strip()
            for head, cell in zip(cells.heads, row, strict=False)
            if cell.strip()
        }
        if FILE not in fields:
            raise ConfigError(f"{path}: has a row without a file; name one in each row")
        listed.append((path.parent / fields.pop(FILE), fields))
    return listed


def read(
    path: Path, calibration: Calibration | None = None, segment: str = "approach"
) -> Mapping[str, Curve | PellicleError]:
    """Return the curves of a file, or the errors of reading them, by their labels.

    The label of a single curve is empty.  A table (CSV, TSV, semicolons, spaces) has a header such
    as ``position [um],force [nN]``; cells that hold no number are NaN, columns of other names are
    ignored, and rows that differ in a column ``curve`` are different curves.  An HDF5 file has
    datasets of the same names with an attribute ``units``, or groups of them, one for each curve; a
    pellicle result is such a file.  The columns of the calibration name other columns of a table,
    and the arrays of any HDF5 or MATLAB file.  Any other file is read by afmformats, which then
    selects the ``segment``.

    Raises
    ------
    ConfigError
        A column or a unit is missing, measures something else, or a column is repeated.
    StorageError
        The file cannot be read.
    """
    before = state(path)
    return Stamped(_read(path, calibration or Calibration(), segment), path, before)


def _read(
    path: Path, calibration: Calibration, segment: str
) -> Mapping[str, Curve | PellicleError]:
    suffix = path.suffix.lower()
    mapped = calibration.columns or {}
    if suffix in _SPREADSHEETS:
        raise StorageError(
            f"{path}: is a spreadsheet; save the sheet of each curve as CSV (in Excel and "
            f"LibreOffice: Save as), with a header such as {EXAMPLE!r}"
        )
    if suffix in afm.SUFFIXES and not (mapped and suffix in _TABLES_TOO):
        if mapped:
            raise ConfigError(
                f"{path} is the file of an instrument, which states what its columns are; leave "
                "columns out",
                "columns",
            )
        return afm.read(path, calibration, segment)
    cells, hint = None, ""
    if suffix in _HDF5:
        tables = read_hdf5(path, mapped)
    elif suffix in _MATLAB:
        tables = read_matlab(path, mapped)
    else:
        cells = read_cells(path, mapped)
        tables = curves_of(path, cells, mapped) if cells else {}
    if not mapped and not any(map(is_curve, tables.values())):
        try:
            return afm.read(path, calibration, segment)
        except StorageError:
            # Only afmformats can recognise the file of an instrument.
            hint = "" if afm.installed() else f"; if it is an instrument's: {afm.INSTALL}"
            if cells is not None:
                first = ", ".join(shown(text) for text in cells.first[:_MANY])
                hint = f"; its first line is {first}, and --columns says what such names are{hint}"
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
