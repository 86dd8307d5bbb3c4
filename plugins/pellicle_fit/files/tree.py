"""Curves in files that hold named arrays in folders: HDF5 and MATLAB."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import nullcontext
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConfigError, StorageError
from pellicle.memory import require_for
from pellicle.schema import fault_of_packing, fault_of_source, hdf5_numbers, read_mat, unpacked_size

from .columns import NAMES, Column, Columns
from .missing import SHOWN

_BYTES_PER_ROW = 100
"""Memory that a row takes until it is fitted."""


def read_tree(
    path: Path, mapped: Mapping[str, str]
) -> tuple[dict[str, Columns], list[Column], dict[str, float]]:
    """Return the columns of each curve of an HDF5 or a MATLAB file by its label, and all heads.

    Without ``mapped`` columns, they are arrays of one axis with the names of columns, at its root
    or else in groups, one for each curve.
    """
    import h5py

    is_matlab = path.suffix.lower() == ".mat"
    try:
        if is_matlab:
            _require(unpacked_size(path), path)
        with nullcontext(read_mat(path)) if is_matlab else h5py.File(path) as root:
            arrays = dict(_arrays(root if is_matlab else root["/"]))
            heads = [Column(name, name, _unit(arrays[name])) for name in islice(arrays, SHOWN + 1)]
            return _curves(path, arrays, mapped, is_matlab=is_matlab), heads, {}
    except ConfigError:
        raise
    except (OSError, RuntimeError, ValueError, LookupError, MemoryError) as error:
        reason = getattr(error, "strerror", "") or error
        kind = "a MATLAB" if is_matlab else "an HDF5"
        remedy = "; copy a classic NetCDF to NetCDF-4: nccopy -k nc4" * (path.suffix == ".nc")
        raise StorageError(f"{path}: cannot be read as {kind} file ({reason}){remedy}") from None


def _arrays(node: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield the arrays of numbers in a folder and below by their paths."""
    # Links of an HDF5 file may lead nowhere or in circles: each folder is entered once.
    entered: set[Any] = set()

    def walk(node: Mapping[str, Any], folder: str) -> Iterator[tuple[str, Any]]:
        entered.add(getattr(node, "id", id(node)))
        for name in node:
            child = node.get(name)
            if isinstance(child, Mapping):
                if getattr(child, "id", id(child)) not in entered:
                    yield from walk(child, f"{folder}{name}/")
            # A type with a name has a dtype, too.
            elif hasattr(child, "ndim") and getattr(child, "dtype", np.dtype("O")).kind in "fiu":
                yield f"{folder}{name}", child

    return walk(node, "")


def _require(needed: float, path: Path) -> None:
    """Refuse a file whose arrays need more memory [bytes] than is available."""
    require_for(needed, f"{path} with all that it unpacks to", "export a part of it")


def _unit(array: Any) -> str:
    attributes = getattr(array, "attrs", {})
    unit = attributes.get("units", attributes.get("unit", ""))
    unit = unit.item() if isinstance(unit, np.ndarray) and unit.size == 1 else unit
    return unit.decode() if isinstance(unit, bytes) else str(unit)


def _curves(
    file: Path, arrays: Mapping[str, Any], mapped: Mapping[str, str], *, is_matlab: bool
) -> dict[str, Columns]:
    """Return the arrays whose paths are ``mapped``, by the labels of their curves.

    The points of a curve are along the first axis of a matrix of MATLAB, or along the last.
    """
    own = {name: name for name in NAMES if name in arrays and arrays[name].ndim == 1}
    channels: dict[str, dict[str, Column]] = {}
    total = 0
    for pattern, text in (mapped or own or {f"*/{name}": name for name in NAMES}).items():
        role, _, unit = text.partition(" ")
        labelled = channels.setdefault(role, {})
        path = pattern.strip("/")
        if "/" not in path and path not in arrays:
            path = path.replace(".", "/")
        named = re.compile(re.escape(path).replace(r"\*", "([^/]+)"))
        for name, array in arrays.items():
            match = named.fullmatch(name)
            if match is None or not (mapped or array.ndim == 1):
                continue
            if not is_matlab and (reason := fault_of_source(array) or fault_of_packing(array)):
                raise ConfigError(f"{file}: {reason}")
            total += array.size
            _require(8.0 * total + _BYTES_PER_ROW * max(array.shape, default=1), file)
            values: Array = np.asarray(array if is_matlab else hdf5_numbers(array), dtype=float)
            rows = {"": values.ravel()}
            if values.squeeze().ndim > 1:
                values = np.moveaxis(values, 0, -1) if is_matlab else values
                rows = {",".join(map(str, i)): values[i] for i in np.ndindex(values.shape[:-1])}
            for row, numbers in rows.items():
                label = "/".join(filter(None, (*match.groups(), row)))
                head = Column(pattern, pattern, _unit(array), numbers)
                labelled[label] = head._replace(unit=head.unit_beside(unit, file))
    labels = dict.fromkeys(label for own in channels.values() for label in own if label)
    # An array that all curves share, such as the time, has no label.
    return {
        label: {r: c for r, own in channels.items() if (c := own.get(label) or own.get(""))}
        for label in labels or [""]
    }
