"""Measured curves of one file, of any known format."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from pellicle.errors import ConfigError, PellicleError, StorageError, shown

from . import afm
from .columns import Calibration, Channel, from_columns, is_curve
from .measurement import Measurement
from .origin import Stamped, state
from .roles import EXAMPLE
from .text_table import curves_of, read_cells
from .tree import read_hdf5, read_matlab

TEXT = (".csv", ".tsv", ".txt")
"""Suffixes of tables."""
_HDF5 = (".h5", ".hdf5", ".nc")
_MATLAB = (".mat",)
SUFFIXES = (*TEXT, *_HDF5, *_MATLAB, *afm.SUFFIXES)
"""Suffixes of the files of a folder that are read."""
_MANY = 8
"""Largest number of texts of a line that a message quotes."""
_TABLES_TOO = (".tab",)
"""Suffixes of instrument files that are tables."""
_SPREADSHEETS = (".xlsx", ".xlsm", ".xls", ".ods", ".numbers")


def read(
    path: Path, calibration: Calibration | None = None, segment: str = "approach"
) -> Mapping[str, Measurement | PellicleError]:
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
) -> Mapping[str, Measurement | PellicleError]:
    """Return the curves of a file by their labels, or the error of each that cannot be read."""
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
    return {
        label: _curve(columns, calibration, f"{path}: curve {label}" if label else str(path), hint)
        for label, columns in tables.items()
    }


def _curve(
    columns: Mapping[str, Channel], calibration: Calibration, name: str, hint: str
) -> Measurement | PellicleError:
    """Return the curve of a table; an error has its ``name``, and ends with a ``hint``."""
    try:
        return from_columns(columns, calibration)
    except ConfigError as error:
        return ConfigError(f"{name}: {error}{hint}")
