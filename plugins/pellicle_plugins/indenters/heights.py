"""Heights from a file or an array."""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from pellicle.arrays import Array
from pellicle.components import shape_of_run
from pellicle.errors import ConfigError
from pellicle.schema import InputPath, fault_of_packing, hdf5_numbers, read_mat, unpacked_size

from .contents import first
from .file_checks import datasets, require_file, require_memory
from .from_heights import FromHeights, HeightUnit, marks_in
from .text_table import FORMAT_MARKS, read_tables, text_in

_KINDS = {".npy": "npy", ".h5": "hdf5", ".hdf5": "hdf5", ".nc": "hdf5", ".mat": "mat"}
"""Kind of a file by its ending; text otherwise."""
_BEYOND = 1e30
"""Number that no height is, in any unit; files mark missing points with such numbers."""


class Heights(FromHeights):
    """Rough punch given by heights at the cell centres; its peaks touch first.

    It ends at the edge of the domain. In Python, ``values`` takes an array instead of a file; the
    configuration then records only its hash, that of the heights as float64 in C order.
    """

    type: Literal["heights"] = "heights"
    examples = ({"path": "heights.txt", "unit": "1 um"},)
    path: InputPath | None = Field(
        None,
        title="file",
        description="file with a 2-D array [along x, along y]: .npy, text (.txt, .csv, .dat) "
        "with blanks, commas or semicolons, .h5 or .mat",
    )
    unit: HeightUnit = Field(
        description="length that a height of 1 in the data stands for [m]: 'um'"
    )
    dataset: str | None = Field(None, description="name of the array in a file that holds several")
    # An array is replaced by its checked copy, which the caller cannot change.
    values: Annotated[
        Any,
        AfterValidator(lambda raw: None if raw is None else checked_array(raw, "the array", "")),
    ] = Field(None, description="array of heights, from the library only", exclude=True, repr=False)

    @model_validator(mode="after")
    def _read(self) -> Self:
        one_source(self.path, self.values, self.sha256)
        heights, name, field = self.values, "the array", "values"
        if self.path is not None:
            name, field = str(self.path), "path"
            heights = checked_array(array_in(self.path, self.dataset), name, field)
        for words in marks_in(heights, 1.0):
            warnings.warn(f"{name} has {words}, fill or crop them", stacklevel=2)
        self._keep(heights, hashlib.sha256(heights.tobytes()).hexdigest(), name)
        return self

    def profile(self, x: Array, y: Array) -> Array:
        """Return (heights − highest) · unit [m]; the grid is of the shape of the array."""
        shape = np.broadcast_shapes(x.shape, y.shape)
        name, field = (str(self.path), "path") if self.path else ("the array", "values")
        require_shape(self._values.shape, shape, name, field)
        below: Array = (self._values - self._values.max()) * self.unit
        return below


def one_source(path: Path | None, values: Any, sha256: str | None) -> None:
    """Refuse values given twice or not at all."""
    if (path is None) == (values is None):
        hint = (
            f" (the configuration records only the hash {sha256} of an array that was in "
            "memory: give values again)"
            if sha256 and path is None
            else ""
        )
        raise ConfigError(f"give either a file or, from the library, values{hint}", "path")


def array_in(path: Path, dataset: str | None) -> Any:
    """Return the only array of a file, or the one called ``dataset``, of usable shape and type."""
    require_file(path)
    kind = _KINDS.get(path.suffix.lower(), "text")
    try:
        with _arrays(path, kind) as arrays:
            if not arrays:
                raise ValueError("it holds no array")
            is_only = len(arrays) == 1 and (dataset is None or kind in ("npy", "text"))
            name = next(iter(arrays)) if is_only else dataset
            if name is None or name not in arrays:
                content = f"no array {name!r}" if name else "more than one array"
                raise ConfigError(f"{path} has {content}; give one of: {first(arrays)}", "dataset")
            array = arrays[name]
            if kind != "text":
                _require_kind(array, str(path), "path")
                if kind == "hdf5" and (reason := fault_of_packing(array)):
                    raise ConfigError(f"{path} {reason}", "dataset")
                if (expected := shape_of_run()) is not None:
                    require_shape(array.shape, expected, str(path), "path")
            return hdf5_numbers(array) if kind == "hdf5" else array[...]
    except ConfigError:
        raise
    # Readers raise anything for damaged files.
    except Exception as error:
        reason = (str(error).splitlines() or [""])[0][:200] or type(error).__name__
        netcdf = ", or read a classic NetCDF as type = 'topography'" * (path.suffix == ".nc")
        raise ConfigError(
            f"{path} cannot be read as {kind} ({reason}); give a 2-D array of numbers as .npy, "
            f"text or .h5{netcdf}",
            "path",
        ) from None


@contextmanager
def _arrays(path: Path, kind: str) -> Iterator[Mapping[str, Any]]:
    """Yield the arrays of an open file by name; those of HDF5 and .npy are not read yet."""
    if kind == "text":
        if (text := text_in(path)).startswith(FORMAT_MARKS):
            raise ConfigError(f"{path} has a scale of its own; read it as 'topography'", "type")
        yield {name: table.values for name, table in read_tables(text, path).items()}
    elif kind == "mat":
        require_memory(2.0 * unpacked_size(path), f"{path} with all that it unpacks to")
        yield {name: value for name, value in read_mat(path).items() if np.ndim(value) == 2}
    elif kind == "hdf5":
        with datasets(path) as arrays:
            yield arrays
    else:
        # A mapped array runs no pickle, and takes no memory whatever shape its header claims.
        yield {"": np.lib.format.open_memmap(path, mode="r")}


def require_shape(shape: tuple[int, ...], expected: tuple[int, ...], name: str, field: str) -> None:
    """Refuse an array, of ``name`` in messages, whose shape is not that of the grid."""
    if shape != expected:
        remedy = f"set grid.points = {list(shape)} and grid.size to match, or resample it"
        if shape == expected[::-1]:
            remedy = (
                "if its rows are lines along x, as those of most scans, transpose it or use type = "
                f"'topography'; otherwise {remedy}"
            )
        raise ConfigError(
            f"{name} is of shape {shape}, [along x, along y], and the grid of shape {expected}; "
            f"{remedy}",
            field,
        )


def _require_kind(raw: Any, name: str, field: str) -> None:
    """Refuse anything but a two-dimensional array of real numbers."""
    array = raw if hasattr(raw, "dtype") and hasattr(raw, "shape") else np.asarray(raw)
    # An HDF5 dataset may have no shape at all.
    kind, shape = array.dtype.kind, tuple(array.shape or ())
    if kind not in "fiu":
        values = "complex" if kind == "c" else str(array.dtype)
        raise ConfigError(f"{name} holds {values} values; give real numbers", field)
    if len(shape) != 2 or 0 in shape:
        remedy = (
            f"; a profile along a line is of shape ({shape[0]}, 1), with grid.points = "
            f'[{shape[0]}, 1] and grid.boundary = "periodic"'
            if len(shape) == 1 and 0 not in shape
            else ""
        )
        raise ConfigError(
            f"{name} is of shape {shape}; give a 2-D array [along x, along y]{remedy}", field
        )


def checked_array(raw: Any, name: str, field: str, content: str = "heights") -> Array:
    """Return values as a new float64 array; refuse those that are masked or not finite."""
    # A sparse matrix has a shape and a type, but is an object to numpy.
    _require_kind(array := np.asarray(raw), name, field)
    bad = ~(np.abs(array) < _BEYOND)
    if masked := np.ma.isMaskedArray(raw):
        bad |= np.ma.getmaskarray(raw)
    if count := np.count_nonzero(bad):
        kinds = "masked, NaN" if masked else "NaN"
        finite = ", or beyond any surface" * (not masked and bool(np.isfinite(array[bad]).any()))
        raise ConfigError(
            f"{name} holds {count} {kinds} or infinite {content}{finite}; fill or crop them first",
            field,
        )
    return np.array(array, dtype=np.float64, order="C")
