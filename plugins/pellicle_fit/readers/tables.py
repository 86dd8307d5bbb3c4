"""Tables in text files, and named arrays in HDF5 and MATLAB files."""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np

from pellicle.errors import ConfigError, StorageError
from pellicle.units import readable
from pellicle_fit.files.choice import TEXT
from pellicle_fit.files.columns import (
    EXAMPLE,
    NAMES,
    Calibration,
    Columns,
    from_columns,
    is_curve,
    missing_parts,
    recalibrate,
)
from pellicle_fit.files.measurement import CurvesByLabel, Measurement
from pellicle_fit.files.missing import missing_in
from pellicle_fit.files.reader import Reader
from pellicle_fit.files.text_table import read_table
from pellicle_fit.files.tree import read_tree


class Table(Reader, title="a table"):
    """A table of numbers in a text with a header; files of unknown suffixes are taken for one."""

    type: Literal["table"] = "table"
    examples = ({},)
    suffixes: ClassVar[tuple[str, ...]] = (*TEXT, ".tab")
    takes_columns: ClassVar[bool] = True

    def sniff(self, path: Path) -> bool:
        """Return whether the columns of a table have the names of those of a curve."""
        with suppress(csv.Error):
            tables, _, _ = read_table(path, {})
            return is_curve(tables[""].keys())
        return True

    def read(self, path: Path, calibration: Calibration) -> CurvesByLabel:
        """Return what reads the only curve."""
        try:
            return _curves(read_table, path, calibration)
        except csv.Error:
            raise StorageError(
                f"{path}: is neither text, nor HDF5, nor a readable file of an instrument; "
                f"export it as a table (a sheet as CSV) with a header such as {EXAMPLE!r}"
            ) from None


class Arrays(Reader, title="named arrays"):
    """Arrays with names in an HDF5 or MATLAB file, at its root or in a group for each curve."""

    type: Literal["arrays"] = "arrays"
    examples = ({},)
    suffixes: ClassVar[tuple[str, ...]] = (".h5", ".hdf5", ".nc", ".mat")
    takes_columns: ClassVar[bool] = True

    def read(self, path: Path, calibration: Calibration) -> CurvesByLabel:
        """Return what reads each curve by the name of its group."""
        return _curves(read_tree, path, calibration)


def _curves(
    read: Callable[[Path, Mapping[str, str]], Any], path: Path, calibration: Calibration
) -> CurvesByLabel:
    """Return what makes each curve of the tables in a file, and raises what it lacks."""
    mapped = calibration.columns or {}
    tables, heads, stated = read(path, mapped)
    names = [name for head in heads if (name := head.name.lower()) in NAMES]
    roles = {role for columns in tables.values() for role in columns}
    roles_by_name = mapped or dict(zip(names, names, strict=True))
    wrong = [name for name, text in roles_by_name.items() if text.split()[0] not in roles]
    known = Calibration(**{**stated, **calibration.model_dump(exclude_none=True)})

    def curve(label: str, columns: Columns) -> Measurement:
        if not wrong and not missing_parts(columns, known):
            own = known.model_copy(update={**stated, "sensitivity": known.sensitivity})
            measured, spring_constant = from_columns(columns, own), calibration.spring_constant
            if (
                spring_constant is None
                and own.spring_constant
                and measured.stiffness != own.spring_constant
            ):
                first, second = own.spring_constant, measured.stiffness or np.nan
                raise ConfigError(
                    f"{path}: states {readable(first, 'N/m')}, and its force is "
                    f"{readable(second, 'N/m')} times its deflection; give the one that holds",
                    "spring_constant",
                )
            return recalibrate(measured, calibration, is_own=bool(stated))
        where = f"{path}: curve {label}" if label else str(path)
        raise missing_in(f"{where}:", heads, wrong, columns, known)

    return {label: partial(curve, label, columns) for label, columns in tables.items()}
