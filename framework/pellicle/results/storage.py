"""Write and read result files: NetCDF-4, one slab along ``step`` per load step, and a checksum.

A file is never changed in place: each version is written under another name, flushed to disk and
renamed, so that every file is complete at any moment. Rewriting the file for each step would take a
time quadratic in the number of steps. So later steps are written to small files beside it, its
segments. When these hold as many steps as the file itself, and at the end, they are merged into it.
Reading merges them too, after verifying checksum and version.

HDF5 writes to memory, and the bytes are then copied to disk, because HDF5 itself ends the process
when the disk is full. What cannot be read or written raises a `StorageError` with the remedy.
"""

from __future__ import annotations

import glob
import io
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pellicle.errors import StorageError
from pellicle.files import atomic_write, is_file, is_folder, storage_errors

from . import checksum, netcdf

if TYPE_CHECKING:
    import h5py
    import xarray as xr

_Kind = Literal["result", "table", "any"]
SCHEMA_VERSION = 3
"""Version of the layout, in the attribute ``schema_version`` of every file."""
REPLACING = (
    "choose another folder (-o DIR), or allow it to be replaced (--overwrite, overwrite=True)"
)
"""Remedy if another file has the name."""
_SMALL = 4_000_000
"""Size [bytes] up to which a file is rewritten for each step, as fast as writing a segment."""


def write(dataset: xr.Dataset, path: Path) -> None:
    """Write the steps of a result, or the table of a study, replacing any old file."""
    fields = [str(name) for name, variable in dataset.data_vars.items() if "x" in variable.dims]
    grows = ["step"] if fields and path.suffix != ".tail" else []
    with atomic_write(path) as part:
        versioned = dataset.assign_attrs(schema_version=SCHEMA_VERSION)
        _save(netcdf.serialise(versioned, grows=grows, packed=fields), part)
        # The segments are removed before the old file is replaced: they must not continue the new.
        for segment in _segments(path):
            segment.unlink()


def remove(path: Path) -> None:
    """Remove a result, if there is one, with its segments."""
    with storage_errors(path):
        for part in (*_segments(path), path):
            part.unlink(missing_ok=True)


def append(dataset: xr.Dataset, path: Path) -> None:
    """Add the steps of ``dataset`` to the result that `write` began."""
    first, *segments = _parts(path)
    with open_file(first) as file:
        identity, own = _attributes_of(file).get("identity"), file["step"][:].tolist()
    waiting = [number for segment in segments for number in _step_numbers(segment)]
    last, following = (own + waiting)[-1], int(dataset["step"].values[0])
    if dataset.attrs.get("identity") != identity or following != last + 1:
        raise StorageError(
            f"{path}: step {following} does not continue it: it ends at step {last}, and another "
            "process may have replaced it; run one at a time, or choose another folder (-o DIR)"
        )
    if len(waiting) + dataset.sizes["step"] >= len(own) or path.stat().st_size < _SMALL:
        _join(path, segments, dataset)
    else:
        write(dataset, path.with_name(f".{path.name}.{len(own) + len(waiting):08d}.tail"))


def close(path: Path) -> None:
    """Merge the segments of a result into its file."""
    _, *segments = _parts(path)
    if segments:
        _join(path, segments)


def read(path: Path, without: Collection[str] = ()) -> xr.Dataset:
    """Return the content of a result file, except variables with a dimension in ``without``.

    If a run merges its segments in the meantime, they are read again.
    """
    while True:
        segments, steps = _segments(path), []
        try:
            for part in _parts(path):
                with open_file(part) as file:
                    steps.append(_content(file, without))
        except StorageError:
            if _segments(path) == segments:
                raise
        else:
            return join_steps(steps)


def attributes(path: Path, kind: _Kind = "result") -> dict[str, Any]:
    """Return the attributes of a result file without reading its steps."""
    with open_file(path, kind) as file:
        return _attributes_of(file)


def join_steps(steps: list[xr.Dataset]) -> xr.Dataset:
    """Return datasets of consecutive steps as one.

    The list is emptied, so that only one field at a time is in memory twice.
    """
    import xarray as xr

    if len(steps) == 1:
        return steps.pop()
    # All steps have the same coordinates, so they need not be compared.
    concat: Any = partial(
        xr.concat,
        dim="step",
        coords="minimal",
        compat="override",
        join="override",
        combine_attrs="override",
    )
    fields = {}
    for name in [str(n) for n, variable in steps[0].data_vars.items() if variable.ndim > 1]:
        fields[name] = concat([step[name] for step in steps])
        steps[:] = [step.drop_vars(name) for step in steps]
    scalars = concat(steps, data_vars="all")
    steps.clear()
    return xr.Dataset({**fields, **scalars.data_vars}, scalars.coords, scalars.attrs)


def table(path: Path) -> xr.Dataset:
    """Return the table of a study."""
    with open_file(path, "table") as file:
        return _content(file)


def _step_numbers(path: Path) -> list[int]:
    with open_file(path) as file:
        numbers: list[int] = file["step"][:].tolist()
        return numbers


def _segments(path: Path) -> list[Path]:
    return sorted(path.parent.glob(f".{glob.escape(path.name)}.*.tail"))


def _parts(path: Path) -> list[Path]:
    """Return the file of a result and the segments that continue it.

    Other segments were merged by a process that ended before it could remove them.
    """
    parts = [path]
    if segments := _segments(path):
        count = len(_step_numbers(path))
        for segment in segments:
            if int(segment.name.split(".")[-2]) == count:
                parts.append(segment)
                count += len(_step_numbers(segment))
    return parts


def _join(path: Path, segments: Sequence[Path], *more: xr.Dataset) -> None:
    """Replace a file by one that also contains the steps of its segments and of ``more``."""
    import h5py

    size = path.stat().st_size
    added = [*(segment.stat().st_size for segment in segments), *(steps.nbytes for steps in more)]
    # Without room BytesIO would copy the content whenever HDF5 writes beyond its end.
    grown = io.BytesIO(bytes(size + sum(added) + _SMALL))
    with _readable(path), path.open("rb") as old, grown.getbuffer() as buffer:
        old.readinto(buffer[:size])
    with h5py.File(grown, "r+") as file:
        names = [name for name in file if file[name].maxshape[:1] == (None,)]
        for segment in segments:
            with open_file(segment) as source:
                _extend(file, {name: source[name] for name in names})
        for steps in more:
            _extend(file, {name: steps[name].values for name in names})
    with atomic_write(path) as part:
        _save(grown, part)
    with storage_errors(path):
        for segment in _segments(path):
            segment.unlink()


def _save(content: io.BytesIO, path: Path) -> None:
    """Write an HDF5 file in memory, and its checksum, to disk."""
    checksum.seal(content)
    # A view that the traceback of a full disk keeps prevents Python from freeing the content.
    with path.open("wb") as file, content.getbuffer() as buffer:
        file.write(buffer)


def _extend(file: h5py.File, values: Mapping[str, Any]) -> None:
    count = file["step"].size
    for name, added in values.items():
        file[name].resize(count + len(added), axis=0)
        file[name][count:] = added


@contextmanager
def open_file(path: Path, kind: _Kind = "result") -> Iterator[h5py.File]:
    """Yield the HDF5 file of a result, of the table of a study or of a command, for reading."""
    if not is_file(path):
        reason = "no such file; give a result file (.h5) that pellicle wrote"
        if is_folder(path):
            reason = "is a folder that holds no result yet; run it first, or give a result (.h5)"
        raise StorageError(f"{path}: {reason}")
    import h5py

    with _readable(path):
        # Before HDF5 parses the file, which for a changed byte can end the process.
        is_sealed = checksum.verify(path)
    with _readable(path), h5py.File(path) as file:
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
                f"{path}: a table that pellicle {command} wrote, not a result; "
                f"xarray.load_dataset reads it; for more, see pellicle {command} --help"
            )
        if kind == "table" and "axes" not in attributes:
            raise StorageError(f"{path}: a result, not the table of a study")
        yield file


def _content(file: h5py.File, without: Collection[str] = ()) -> xr.Dataset:
    dataset = netcdf.dataset(file, without=without)
    dataset.attrs = _attributes_of(file)
    return dataset


def _attributes_of(file: h5py.File) -> dict[str, Any]:
    """Return the attributes of a file, without its schema version."""
    return {n: value for n, value in netcdf.attributes(file).items() if n != "schema_version"}


@contextmanager
def _readable(path: Path) -> Iterator[None]:
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
        raise StorageError(
            f"{path}: not a readable result file ({reason}); give an .h5 file that pellicle wrote"
        ) from None
