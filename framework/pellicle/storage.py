"""The one HDF5 layout: NetCDF-4 through h5netcdf, one slab along ``step`` per load step.

A file is never changed in place: each version is written aside, flushed to disk and renamed, so
that whatever ends the process, the name holds a whole file with every step finished before.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .errors import StorageError

if TYPE_CHECKING:
    import xarray as xr

SCHEMA_VERSION = 1
"""Version of the layout, in the attribute ``schema_version`` of every file."""


def write(dataset: xr.Dataset, path: Path) -> None:
    """Write ``dataset`` (with a dimension ``step``) as a new file, in place of an old one.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    # Fields compress two- to tenfold at the lowest level; higher ones only cost time.
    packed = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
    encoding: dict[Any, Any] = {
        name: packed for name, variable in dataset.data_vars.items() if variable.ndim > 1
    }
    with _aside(path) as aside:
        dataset.assign_attrs(schema_version=SCHEMA_VERSION).to_netcdf(
            aside, engine="h5netcdf", unlimited_dims=["step"], encoding=encoding
        )


def append(dataset: xr.Dataset, path: Path) -> None:
    """Add the steps of ``dataset`` to the file that `write` made.

    Raises
    ------
    StorageError
        The file cannot be read or written.
    """
    import h5netcdf

    with _aside(path) as aside:
        shutil.copyfile(path, aside)
        with h5netcdf.File(aside, "a") as file:
            done = file.dimensions["step"].size
            total = done + dataset.sizes["step"]
            file.resize_dimension("step", total)
            for name, variable in dataset.variables.items():
                if "step" in variable.dims:
                    values = variable.values
                    stored = file.variables[name]
                    stored[done:total] = values.astype("i1") if values.dtype == bool else values


def read(path: Path) -> xr.Dataset:
    """Return the whole content of a result file.

    Raises
    ------
    StorageError
        No such file, not a result of pellicle, damaged, or of another schema version.
    """
    with _opened(path) as dataset:
        return dataset.load()


def configuration(path: Path) -> str:
    """Return the configuration whose result a file holds, without reading its fields.

    Raises
    ------
    StorageError
        As for `read`.
    """
    with _opened(path) as dataset:
        return str(dataset.attrs["configuration"])


@contextmanager
def _opened(path: Path) -> Iterator[xr.Dataset]:
    """Yield the dataset in a file, its values not yet read."""
    import xarray as xr

    if not path.is_file():
        raise StorageError(f"{path}: no such file; give a result file (.h5) that pellicle wrote")
    try:
        # Phony dimensions only let a foreign file open far enough to be told apart.
        with xr.open_dataset(path, engine="h5netcdf", phony_dims="sort") as dataset:
            version = dataset.attrs.pop("schema_version", None)
            if version is None or not {"configuration", "versions"} <= dataset.attrs.keys():
                raise StorageError(
                    f"{path}: not a result of pellicle; give an .h5 file that pellicle wrote"
                )
            if version != SCHEMA_VERSION:
                raise StorageError(
                    f"{path}: schema version {version}, and this pellicle reads {SCHEMA_VERSION}; "
                    f"read it with what wrote it ({dataset.attrs['versions']}), or run it again"
                )
            yield dataset
    # The layers below raise nearly anything for a file that is damaged or no HDF5.
    except (OSError, ValueError, LookupError, RuntimeError, AttributeError, TypeError) as error:
        reason = str(error).partition("\n")[0]
        raise StorageError(
            f"{path}: not a readable result file ({reason}); give an .h5 file that pellicle wrote"
        ) from None


def check_writable(path: Path) -> None:
    """Find out before computing whether a file can be written at ``path``.

    Raises
    ------
    StorageError
        It cannot.
    """
    with reported(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path.parent):
            pass


@contextmanager
def reported(path: Path) -> Iterator[None]:
    """Turn a failure to write ``path`` into a StorageError that says what to do."""
    try:
        yield
    except OSError as error:
        raise StorageError(
            f"{path}: cannot be written ({error.strerror or error}); choose another folder"
        ) from None


@contextmanager
def _aside(path: Path) -> Iterator[Path]:
    """Yield a name to write to; rename it to ``path`` when whole, leave nothing when not."""
    aside = path.with_name(f".{path.name}.{os.getpid()}.part")
    with reported(path):
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            yield aside
            with aside.open("rb+") as file:
                os.fsync(file.fileno())
            aside.replace(path)
        finally:
            aside.unlink(missing_ok=True)
