"""Curves in files that hold named arrays in folders: HDF5 and MATLAB."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import nullcontext
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import PellicleError, StorageError
from pellicle.schema import read_mat

from .columns import NAMES, Channel, Columns
from .heads import Head
from .missing import SHOWN

_DEEPEST = 8
"""Largest depth of folders that a message describes; links can make circles."""


def read_tree(path: Path, mapped: Mapping[str, str]) -> tuple[dict[str, Columns], list[Head]]:
    """Return the columns of each curve of an HDF5 or a MATLAB file by its label, and all heads.

    Without ``mapped`` columns, they are arrays of one axis with the names of columns, at its root
    or else in groups, one for each curve.
    """
    import h5py

    is_matlab = path.suffix.lower() == ".mat"
    try:
        with nullcontext(read_mat(path)) if is_matlab else h5py.File(path) as root:
            curves = _curves(root, mapped, is_matlab=is_matlab)
            return curves, [*islice(_heads(root, _DEEPEST), SHOWN + 1)]
    except PellicleError:
        raise
    except (OSError, RuntimeError, ValueError) as error:
        kind = "a MATLAB" if is_matlab else "an HDF5"
        reason = getattr(error, "strerror", "") or error
        raise StorageError(f"{path}: cannot be read as {kind} file ({reason})") from None


def _kind(array: Any) -> str:
    """Return the kind of the numbers of an array; a space for anything else."""
    return str(getattr(getattr(array, "dtype", None), "kind", " "))


def _unit(array: Any) -> str:
    attributes = getattr(array, "attrs", {})
    unit = attributes.get("units", attributes.get("unit", ""))
    return unit.decode() if isinstance(unit, bytes) else str(unit)


def _curves(root: Any, mapped: Mapping[str, str], *, is_matlab: bool) -> dict[str, Columns]:
    """Return the arrays whose paths are ``mapped``, by the labels of their curves.

    The points of a curve are along the first axis of a matrix of MATLAB, or along the last.
    """
    own = {name: name for name in NAMES if getattr(root.get(name), "ndim", 0) == 1}
    channels: dict[str, dict[str, Channel]] = {}
    for pattern, text in (mapped or own or {f"*/{name}": name for name in NAMES}).items():
        role, _, unit = text.partition(" ")
        arrays = channels.setdefault(role, {})
        # The separators of a path are slashes or points.
        parts = pattern.strip("/").split("/")
        if len(parts) == 1 and parts[0] not in root:
            parts = parts[0].split(".")
        for label, array in _leaves(root, parts):
            if not mapped and array.ndim != 1:
                continue
            values: Array = np.asarray(array, dtype=float)
            rows = {"": values.ravel()}
            if values.squeeze().ndim > 1:
                values = np.moveaxis(values, 0, -1) if is_matlab else values
                rows = {",".join(map(str, i)): values[i] for i in np.ndindex(values.shape[:-1])}
            for row, numbers in rows.items():
                whole = "/".join(filter(None, (label, row)))
                arrays[whole] = Channel(unit or _unit(array), numbers, pattern if mapped else "")
    labels = dict.fromkeys(label for own in channels.values() for label in own if label)
    # An array that all curves share, such as the time, has no label.
    found = {
        label: {role: own.get(label, own.get("")) for role, own in channels.items()}
        for label in labels or [""]
    }
    return {label: {r: c for r, c in columns.items() if c} for label, columns in found.items()}


def _leaves(node: Any, parts: list[str], label: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the arrays at a path, each with the names that stand for its ``*``."""
    if not parts:
        if _kind(node) in "fiu":
            yield label, node
        return
    part, *rest = parts
    if isinstance(node, Mapping) and part == "*":
        for name in node:
            yield from _leaves(node.get(name), rest, f"{label}/{name}" if label else str(name))
    elif isinstance(node, Mapping):
        # A link of an HDF5 file may lead nowhere.
        yield from _leaves(node.get(part), rest, label)


def _heads(node: Mapping[str, Any], depth: int, folder: str = "") -> Iterator[Head]:
    for name in node:
        child = node.get(name)
        if isinstance(child, Mapping) and depth:
            yield from _heads(child, depth - 1, f"{folder}{name}/")
        elif _kind(child) in "fiu":
            yield Head(f"{folder}{name}", f"{folder}{name}", _unit(child))
