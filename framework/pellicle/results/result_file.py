"""Open the HDF5 file of a result or a table, after verifying its checksum and version."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pellicle.errors import StorageError
from pellicle.files import is_file, is_folder

from . import checksum, netcdf

if TYPE_CHECKING:
    import h5py
    import xarray as xr

SCHEMA_VERSION = 3
"""Version of the layout, in the attribute ``schema_version`` of every file."""


@contextmanager
def opened(path: Path, kind: Literal["result", "table"] = "result") -> Iterator[h5py.File]:
    """Yield the HDF5 file of a result or of the table of a study, for reading."""
    if not is_file(path):
        reason = "no such file; give a result file (.h5) that pellicle wrote"
        if is_folder(path):
            reason = "is a folder that holds no result yet; run it first, or give a result (.h5)"
        raise StorageError(f"{path}: {reason}")
    import h5py

    with readable(path):
        # Before HDF5 parses the file, which for a changed byte can end the process.
        is_sealed = checksum.verify(path)
    with readable(path), h5py.File(path) as file:
        attributes = netcdf.attributes(file)
        version = attributes.get("schema_version")
        if version is None or not {"configuration", "versions"} <= attributes.keys():
            raise StorageError(
                f"{path}: not a result of pellicle; give an .h5 file that pellicle wrote"
            )
        if version != SCHEMA_VERSION:
            raise StorageError(
                f"{path}: schema version {version}, and this pellicle reads {SCHEMA_VERSION}; "
                f"read it with what wrote it ({attributes['versions']}), or run it again"
            )
        if not is_sealed:
            raise StorageError(
                f"{path}: was changed after pellicle wrote it, its checksum is missing; restore it "
                "from a copy, or run it again"
            )
        if kind == "result" and "axes" in attributes:
            raise StorageError(
                f"{path}: the table of a study, not a result; pellicle.run_study returns it, "
                "xarray.load_dataset reads it, and runs/ holds the results"
            )
        if kind == "result" and (command := attributes.get("command")):
            raise StorageError(
                f"{path}: a table that pellicle {command} wrote, not a result; pellicle show "
                f"{path.parent} prints it; for more, see pellicle {command} --help"
            )
        if kind == "table" and "axes" not in attributes:
            raise StorageError(f"{path}: a result, not the table of a study")
        yield file


def content(file: h5py.File, without: Collection[str] = ()) -> xr.Dataset:
    """Return the dataset in a file, except variables with a dimension in ``without``."""
    dataset = netcdf.dataset(file, without=without)
    dataset.attrs = attributes_of(file)
    return dataset


def attributes_of(file: h5py.File) -> dict[str, Any]:
    """Return the attributes of a file, without its schema version."""
    return {n: value for n, value in netcdf.attributes(file).items() if n != "schema_version"}


@contextmanager
def readable(path: Path) -> Iterator[None]:
    """Turn exceptions that a damaged file causes into a StorageError that names the remedy."""
    try:
        yield
    # h5py, numpy, xarray and json raise any of these for a file that is damaged or not HDF5.
    except (
        *(OSError, ValueError, LookupError, RuntimeError, AttributeError, TypeError),
        MemoryError,
    ) as error:
        reason = str(error).partition("\n")[0] or "it does not fit in memory"
        if "file signature not found" in reason:
            reason = "it is not an HDF5 file"
        beside = path.with_suffix(".h5")
        remedy = str(beside) if is_file(beside) and beside != path else "an .h5 file"
        raise StorageError(
            f"{path}: not a readable result file ({reason}); give {remedy} that pellicle wrote"
        ) from None
