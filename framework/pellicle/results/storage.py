"""The one HDF5 layout: NetCDF-4, one slab along ``step`` per load step, and a checksum behind it.

A file is never changed in place: each version is written aside, flushed to disk and renamed, so
that whatever ends the process, every name holds a whole file. Rewriting a file for each step would
take a time quadratic in the steps, so new ones wait in small files beside it, its tails, until they
are as many as its own; then, and at the end, they are joined to it. Reading joins them too.

HDF5 writes to memory, and what it made is copied to disk: on a full disk HDF5 ends the process.
"""

from __future__ import annotations

import glob
import io
import json
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from pellicle.errors import StorageError, shown

from . import checksum, netcdf, version_1

if TYPE_CHECKING:
    import h5py
    import xarray as xr
from pellicle.files import atomic_write, storage_errors

Read = TypeVar("Read")


SCHEMA_VERSION = 2
"""Version of the layout, in the attribute ``schema_version`` of every file.

Files of version 1 are read: they have no checksum and no codes of statuses, and count their steps
from 0.
"""


REPLACING = (
    "choose another folder (-o DIR), or allow it to be replaced (--overwrite, overwrite=True)"
)
"""What to do where a file of something else is in the way."""


_SMALL = 4_000_000
"""Files that are copied for each step [bytes]: it takes no longer than beginning another one."""


def write(dataset: xr.Dataset, path: Path) -> None:
    """Write ``dataset``, steps of a result or the table of a study, in place of an old file.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    fields = [str(name) for name, each in dataset.data_vars.items() if "x" in each.dims]
    grows = ["step"] if fields and path.suffix != ".tail" else []
    with atomic_write(path) as part:
        described = dataset.assign_attrs(schema_version=SCHEMA_VERSION)
        image = netcdf.image(described, grows=grows, packed=fields)
        checksum.seal(image)
        part.write_bytes(image.getbuffer())
        # While the old file still has the name: its tails must never continue the new one.
        for tail in _tails(path):
            tail.unlink()


def append(dataset: xr.Dataset, path: Path) -> None:
    """Add the steps of ``dataset`` to the result that `write` began.

    Raises
    ------
    StorageError
        The file cannot be read or written, or ``dataset`` does not continue it.
    """
    first, *tails = _parts(path)
    with opened(first) as file:
        version, identity = _version(file), _attributes(file).get("identity")
        own = file["step"][:].tolist()
    waiting = [number for tail in tails for number in _step_numbers(tail)]
    # Version 1 counted from 0.
    _require_continued(path, (own + waiting)[-1] + (version == 1), identity, dataset)
    if version != SCHEMA_VERSION:
        write(joined([read(path), dataset]), path)
    elif len(waiting) + dataset.sizes["step"] >= len(own) or path.stat().st_size < _SMALL:
        _join(path, tails, dataset)
    else:
        write(dataset, path.with_name(f".{path.name}.{len(own) + len(waiting):08d}.tail"))


def _require_continued(path: Path, step: int, identity: object, dataset: xr.Dataset) -> None:
    """Refuse steps of another run, or those that do not follow ``step``, the last of the file."""
    following = int(dataset["step"].values[0])
    if dataset.attrs.get("identity") != identity or following != step + 1:
        raise StorageError(
            f"{path}: step {following} does not continue it: it ends at step {step}, and another "
            "process may have replaced it; run one at a time, or choose another folder (-o DIR)"
        )


def require_consecutive(steps: xr.Dataset, path: Path) -> None:
    """Refuse to resume a file whose steps are not 1, 2, …: two processes may have written it.

    Raises
    ------
    StorageError
        They are not.
    """
    numbers = steps["step"].values.tolist()
    if numbers != list(range(1, len(numbers) + 1)):
        raise StorageError(
            f"{path}: its steps are {shown(numbers)}, not 1, 2, …, so it cannot be resumed; "
            f"{REPLACING}"
        )


def close(path: Path) -> None:
    """Make the result that `write` began and its tails one file.

    Raises
    ------
    StorageError
        The file cannot be read or written.
    """
    _, *tails = _parts(path)
    if tails:
        _join(path, tails)


def read(path: Path) -> xr.Dataset:
    """Return the whole content of a result file.

    Raises
    ------
    StorageError
        No such file, not a result of pellicle, damaged, or of another schema version.
    """
    return joined(_from_parts(path, _content))


def scalars(path: Path) -> xr.Dataset:
    """Return what a result file says of each step, without its fields.

    Raises
    ------
    StorageError
        As for `read`.
    """
    return joined(_from_parts(path, partial(_content, without=["x", "y"])))


def attributes(path: Path) -> dict[str, Any]:
    """Return where a result comes from, without reading its steps.

    Raises
    ------
    StorageError
        As for `read`.
    """
    with opened(path) as file:
        return _attributes(file)


def fields(path: Path, names: Sequence[str], step: int) -> tuple[dict[str, Any], list[Any]]:
    """Return the attributes of a result file and fields of one of its steps, and read nothing else.

    Raises
    ------
    StorageError
        As for `read`, or there is no such field or step.
    """
    for part in _parts(path):
        with opened(part) as file:
            held = file["step"].size
            if step < held:
                return _attributes(file), [file[name][step] for name in names]
            step -= held
    raise StorageError(f"{path} does not hold that many steps; run it again")


def joined(steps: list[xr.Dataset]) -> xr.Dataset:
    """Return datasets of consecutive steps as one.

    The list is used up: of the fields, only the one that is being joined is in memory twice.
    """
    import xarray as xr

    if len(steps) == 1:
        return steps.pop()
    # Coordinates are the same in all steps, so nothing needs comparing.
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
    """Return the table of a study.

    Raises
    ------
    StorageError
        As for `read`.
    """
    with opened(path, "table") as file:
        return _content(file)


@contextmanager
def opened(path: Path, kind: Literal["result", "table"] = "result") -> Iterator[h5py.File]:
    """Yield the file of a result or of a study's table, to be read.

    Raises
    ------
    StorageError
        As for `read`.
    """
    if not path.is_file():
        found = "is a folder" if path.is_dir() else "no such file"
        raise StorageError(f"{path}: {found}; give a result file (.h5) that pellicle wrote")
    with _readable(path), _parsed(path) as file:
        known = netcdf.attributes(file)
        version = _version(file)
        if version is None or not {"configuration", "versions"} <= known.keys():
            raise StorageError(
                f"{path}: not a result of pellicle; give an .h5 file that pellicle wrote"
            )
        if version not in (1, SCHEMA_VERSION):
            raise StorageError(
                f"{path}: schema version {version}, and this pellicle reads 1 to {SCHEMA_VERSION}; "
                f"read it with what wrote it ({known['versions']}), or run it again"
            )
        if not isinstance(json.loads(known["configuration"]), dict):
            raise ValueError("its configuration is not a table")
        if kind == "result" and "axes" in known:
            raise StorageError(
                f"{path}: the table of a study, not a result; open it with xarray, or give one "
                "of the results in runs/"
            )
        if kind == "table" and "axes" not in known:
            raise StorageError(f"{path}: a result, not the table of a study")
        yield file


@contextmanager
def _parsed(path: Path) -> Iterator[h5py.File]:
    """Yield the content of a file whose checksum, if it has one, matches."""
    import h5py

    sealed = checksum.verify(path)
    with h5py.File(path) as file:
        if not sealed and _version(file) == SCHEMA_VERSION:
            raise StorageError(
                f"{path}: was changed after pellicle wrote it, its checksum is missing; restore it "
                "from a copy, or run it again"
            )
        yield file


def _version(file: h5py.File) -> Any:
    return netcdf.attributes(file).get("schema_version")


def _content(file: h5py.File, without: Collection[str] = ()) -> xr.Dataset:
    content = netcdf.dataset(file, without=without)
    if _version(file) == 1:
        content = version_1.completed(content)
    content.attrs = _attributes(file)
    return content


def _attributes(file: h5py.File) -> dict[str, Any]:
    return {n: value for n, value in netcdf.attributes(file).items() if n != "schema_version"}


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    """Turn whatever a damaged file raises into a StorageError that says what to do."""
    try:
        yield
    # The layers below raise nearly anything for a file that is damaged or no HDF5.
    except (
        *(OSError, ValueError, LookupError, RuntimeError, AttributeError, TypeError),
        MemoryError,
    ) as error:
        reason = str(error).partition("\n")[0] or "it does not fit in memory"
        raise StorageError(
            f"{path}: not a readable result file ({reason}); give an .h5 file that pellicle wrote"
        ) from None


def _from_parts(path: Path, read: Callable[[h5py.File], Read]) -> list[Read]:
    """Return what ``read`` returns for each file of a result, in order of the steps.

    A run that goes on may join the files while they are read: then they are looked for again.
    """
    while True:
        tails, results = _tails(path), []
        try:
            for part in _parts(path):
                with opened(part) as file:
                    results.append(read(file))
        except StorageError:
            if _tails(path) == tails:
                raise
        else:
            return results


def _step_numbers(path: Path) -> list[int]:
    """Return the numbers of the steps that a file of its own holds, as they stand there."""
    with _readable(path), _parsed(path) as file:
        return file["step"][:].tolist()  # type: ignore[no-any-return]


def _tails(path: Path) -> list[Path]:
    return sorted(path.parent.glob(f".{glob.escape(path.name)}.*.tail"))


def _parts(path: Path) -> list[Path]:
    """Return the files that together are a result: itself, and the tails that continue it.

    A tail that does not was joined by a process that ended before it could remove it.
    """
    parts = [path]
    if tails := _tails(path):
        held = len(_step_numbers(path))
        for tail in tails:
            if int(tail.name.split(".")[-2]) == held:
                parts.append(tail)
                held += len(_step_numbers(tail))
    return parts


def _join(path: Path, tails: Sequence[Path], *more: xr.Dataset) -> None:
    """Replace a file by itself, its tails and more steps."""
    import h5py

    with atomic_write(path) as part:
        image = _with_room(path, sum(tail.stat().st_size for tail in tails) + _bytes(more))
        with h5py.File(image, "r+") as file:
            for tail in tails:
                with _readable(tail), _parsed(tail) as source:
                    _extend(file, {name: source[name] for name in file if _grows(file[name])})
            for dataset in more:
                values = {str(name): each.values for name, each in dataset.variables.items()}
                _extend(file, {name: values[name] for name in file if _grows(file[name])})
        checksum.seal(image)
        part.write_bytes(image.getbuffer())
    with storage_errors(path):
        for tail in _tails(path):
            tail.unlink()


def _with_room(path: Path, room: int) -> io.BytesIO:
    """Return the content of a file in memory, with room to grow by without being copied."""
    size = path.stat().st_size
    image = io.BytesIO(bytes(size + room + _SMALL))
    with path.open("rb") as file, image.getbuffer() as whole:
        file.readinto(whole[:size])
    return image


def _bytes(datasets: Sequence[xr.Dataset]) -> int:
    return sum(dataset.nbytes for dataset in datasets)


def _grows(stored: h5py.Dataset) -> bool:
    return bool(stored.maxshape[:1] == (None,))


def _extend(file: h5py.File, values: Mapping[str, Any]) -> None:
    done = file["step"].size
    for name, added in values.items():
        file[name].resize(done + len(added), axis=0)
        file[name][done:] = added
