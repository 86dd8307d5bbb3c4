"""Measured curves of one file, of any known format."""

from __future__ import annotations

import csv
import os
from contextlib import suppress
from functools import partial
from pathlib import Path

import numpy as np

from pellicle.errors import ConfigError, StorageError
from pellicle.files import is_file, is_folder
from pellicle.units import readable

from . import afm
from .columns import (
    EXAMPLE,
    NAMES,
    Calibration,
    Columns,
    from_columns,
    is_curve,
    lacking,
    recalibrated,
)
from .measurement import Measurement, Readers
from .missing import missing_in
from .text_table import read_table
from .tree import read_tree

TEXT = (".csv", ".tsv", ".txt")
"""Suffixes of tables."""
_TREES = (".h5", ".hdf5", ".nc", ".mat")
SUFFIXES = (*TEXT, *_TREES, *afm.SUFFIXES)
"""Suffixes of the files of a folder that are read."""


def read(path: Path, calibration: Calibration | None = None) -> Readers:
    """Return functions that read the curves of a file, and raise what this one does.

    The columns of the calibration name those of a table, and the arrays of an HDF5 or MATLAB file.
    Files of instruments are read by afmformats, and so are three columns without names.
    """
    calibration = calibration or Calibration()
    suffix, mapped = path.suffix.lower(), calibration.columns or {}
    if os.path.exists(path) and not (is_file(path) or is_folder(path)):
        raise StorageError(f"{path}: is a pipe or a device; give a file")
    if suffix not in TEXT and not mapped and afm.is_instrument(path):
        return afm.read_instrument(path, calibration)
    # The columns of a table can be named though it is an instrument's.
    if suffix in afm.SUFFIXES and suffix != ".tab":
        raise ConfigError(f"{path} states what its columns are; leave columns out", "columns")
    try:
        tables, heads, stated = (read_tree if suffix in _TREES else read_table)(path, mapped)
    except csv.Error:
        raise StorageError(
            f"{path}: is neither text, nor HDF5, nor a readable file of an instrument; "
            f"export it as a table (a sheet as CSV) with a header such as {EXAMPLE!r}"
        ) from None
    if suffix in TEXT and not mapped and not is_curve(tables[""].keys()):
        if afm.is_instrument(path):
            return afm.read_instrument(path, calibration)
        if suffix == ".txt" and [head.text for head in heads] == [""] * 3:
            with suppress(StorageError):
                return afm.read_instrument(path, calibration)
    names = [name for head in heads if (name := head.name.lower()) in NAMES]
    found = {role for columns in tables.values() for role in columns}
    wanted = mapped or dict(zip(names, names, strict=True))
    wrong = [name for name, text in wanted.items() if text.split()[0] not in found]
    known = Calibration(**{**stated, **calibration.model_dump(exclude_none=True)})

    def curve(label: str, columns: Columns) -> Measurement:
        if not wrong and not lacking(columns, known):
            own = known.model_copy(update={**stated, "sensitivity": known.sensitivity})
            measured, given = from_columns(columns, own), calibration.spring_constant
            if given is None and own.spring_constant and measured.stiffness != own.spring_constant:
                first, other = own.spring_constant, measured.stiffness or np.nan
                raise ConfigError(
                    f"{path}: states {readable(first, 'N/m')}, and its force is "
                    f"{readable(other, 'N/m')} times its deflection; give the one that holds",
                    "spring_constant",
                )
            return recalibrated(measured, calibration, is_own=bool(stated))
        where = f"{path}: curve {label}" if label else str(path)
        raise missing_in(f"{where}:", heads, wrong, columns, known)

    return {label: partial(curve, label, columns) for label, columns in tables.items()}
