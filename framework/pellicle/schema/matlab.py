"""Read the variables of MATLAB files, old (version 5) and new (7.3, which is HDF5)."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .hdf5 import fault_of_source

_COMPRESSED = 15
"""Type of a compressed variable of version 5."""


def read_mat(path: Path) -> dict[str, Any]:
    """Return the variables of a file by name.

    Structures are dictionaries; cell arrays and arrays of structures are dictionaries whose keys
    count from 1.  Arrays have the axes that they have in MATLAB.

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        The file is not a MATLAB file, or takes values from other files.
    """
    import h5py
    from scipy.io import loadmat

    if h5py.is_hdf5(path):
        return _read_hdf5(path)

    try:
        content = loadmat(path, simplify_cells=True)
    except OSError:
        raise
    except Exception as error:
        # scipy raises errors of zlib, of struct and of its own for damaged files.
        raise ValueError(str(error) or type(error).__name__) from None
    return {name: _plain(value) for name, value in content.items() if not name.startswith("__")}


def unpacked_size(path: Path) -> int:
    """Return the size [bytes] that the compressed variables of a MATLAB file state."""
    import h5py

    sizes = []
    if h5py.is_hdf5(path):
        with h5py.File(path) as content:
            content.visititems(lambda _, item: sizes.append(getattr(item, "nbytes", 0)))
        return sum(sizes)
    with path.open("rb") as file:
        end = file.read(128)[126:]
        order = "<II" if end == b"IM" else ">II"
        while end in (b"IM", b"MI") and len(tag := file.read(8)) == 8:
            kind, size = struct.unpack(order, tag)
            if kind == _COMPRESSED:
                head = zlib.decompressobj().decompress(file.peek(64)[:size], 8)
                sizes.append(struct.unpack(order, head)[1])
            file.seek(size, 1)
    return sum(sizes)


def _plain(value: Any) -> Any:
    """Return a structure, a cell array or an array of structures as a dictionary."""
    if isinstance(value, Mapping):
        return {str(name): _plain(entry) for name, entry in value.items()}
    if isinstance(value, np.ndarray) and value.dtype == object:
        value = value.ravel(order="F").tolist()
    if isinstance(value, list):
        return {str(number): _plain(entry) for number, entry in enumerate(value, 1)}
    return value


def _read_hdf5(path: Path) -> dict[str, Any]:
    import h5py

    entered: set[Any] = set()

    def content(item: Any) -> Any:
        # A link may lead nowhere, to a type or in circles: groups and cells are entered once.
        if not isinstance(item, (h5py.Group, h5py.Dataset)) or item in entered:
            return {}
        if isinstance(item, h5py.Group):
            entered.add(item)
            return {str(name): content(entry) for name, entry in item.items()}
        if reason := fault_of_source(item):
            raise ValueError(f"it {reason}")
        if item.dtype == h5py.ref_dtype:
            entered.add(item)
            references = np.atleast_1d(item[()]).ravel()
            return {str(n): content(file[ref]) for n, ref in enumerate(references, 1) if ref}
        return np.asarray(item[()]).T

    with h5py.File(path) as file:
        entered.add(file["/"])
        # "#refs#" and "#subsystem#" hold what variables refer to.
        return {name: content(item) for name, item in file.items() if not name.startswith("#")}
