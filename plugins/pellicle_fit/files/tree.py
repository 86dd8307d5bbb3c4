"""Curves in files that hold named arrays in folders: HDF5 and MATLAB."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConfigError, StorageError, shown
from pellicle.schema import read_mat

from .columns import NAMES, Channel, Columns

_SHOWN = 8
"""Largest number of arrays that a message names."""
_DEEPEST = 8
"""Largest depth of folders that a message describes; links can make circles."""


def read_hdf5(path: Path, mapped: Mapping[str, str]) -> dict[str, Columns]:
    """Return the columns of each curve of an HDF5 file by its label.

    Raises
    ------
    StorageError
        The file cannot be read.
    ConfigError
        A path in ``mapped`` leads to no array of numbers.
    """
    import h5py

    def standard(group: h5py.Group) -> Columns:
        found = {name: group.get(name) for name in NAMES}
        return {
            name: Channel(_unit(dataset), np.asarray(dataset, dtype=float))
            for name, dataset in found.items()
            if isinstance(dataset, h5py.Dataset) and dataset.ndim == 1 and _kind(dataset) in "fiu"
        }

    try:
        with h5py.File(path) as file:
            if mapped:
                return _mapped(path, file, mapped, first=False)
            if columns := standard(file):
                return {"": columns}
            groups = {
                str(name): standard(group)
                for name, group in file.items()
                if isinstance(group, h5py.Group)
            }
    except (OSError, RuntimeError) as error:
        reason = getattr(error, "strerror", "") or error
        raise StorageError(f"{path}: cannot be read as an HDF5 file ({reason})") from None
    return {name: columns for name, columns in groups.items() if columns} or {"": {}}


def read_matlab(path: Path, mapped: Mapping[str, str]) -> dict[str, Columns]:
    """Return the columns of each curve of a MATLAB file by its label.

    Raises
    ------
    StorageError
        The file cannot be read.
    ConfigError
        No columns are ``mapped``, or a path leads to no array of numbers.
    """
    try:
        content = read_mat(path)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", "") or error
        raise StorageError(f"{path}: cannot be read as a MATLAB file ({reason})") from None
    if not mapped:
        raise ConfigError(
            f"is missing: {path} does not hold units; it has {_content(content)}; say what they "
            "are, such as 'z = extension nm, d = deflection nm' (--columns on the command line)",
            "columns",
        )
    return _mapped(path, content, mapped, first=True)


def _kind(array: Any) -> str:
    """Return the kind of the numbers of an array; a space for anything else."""
    return str(getattr(getattr(array, "dtype", None), "kind", " "))


def _unit(array: Any) -> str:
    attributes = getattr(array, "attrs", {})
    unit = next((attributes[name] for name in ("units", "unit") if name in attributes), "")
    return unit.decode() if isinstance(unit, bytes) else str(unit)


def _mapped(path: Path, root: Any, mapped: Mapping[str, str], *, first: bool) -> dict[str, Columns]:
    """Return the arrays whose paths are ``mapped``, by the labels of their curves.

    The points of a curve are along the ``first`` axis of an array of several, or along the last.
    """
    channels: dict[str, dict[str, Channel]] = {}
    for pattern, text in mapped.items():
        role, _, unit = text.partition(" ")
        arrays = channels.setdefault(role, {})
        # The separators of a path are slashes or points.
        parts = pattern.strip("/").split("/")
        if len(parts) == 1 and parts[0] not in root:
            parts = parts[0].split(".")
        for label, array in _leaves(root, parts):
            values: Array = np.asarray(array, dtype=float)
            rows = {"": values.ravel()}
            if values.squeeze().ndim > 1:
                values = np.moveaxis(values, 0, -1) if first else values
                rows = {",".join(map(str, i)): values[i] for i in np.ndindex(values.shape[:-1])}
            for row, numbers in rows.items():
                whole = "/".join(filter(None, (label, row)))
                arrays[whole] = Channel(unit or _unit(array), numbers, pattern)
        if not arrays:
            raise ConfigError(
                f"{path}: has no array of numbers at {pattern!r} (it has {_content(root)})",
                "columns",
            )
    curves: dict[str, Columns] = {}
    for label in max(channels.values(), key=len):
        # An array that all curves share, such as the time, has no label.
        columns = {role: own.get(label) or own.get("") for role, own in channels.items()}
        if missing := [role for role, column in columns.items() if column is None]:
            raise ConfigError(f"{path}: curve {label} has no {missing[0]}", "columns")
        curves[label] = {role: column for role, column in columns.items() if column is not None}
    return curves


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
    elif part in (getattr(getattr(node, "dtype", None), "names", None) or ()):
        yield from _leaves(node[part], rest, label)


def _content(root: Any) -> str:
    """Return the first paths of the arrays in a file as text."""
    paths: list[str] = []

    def visit(node: Mapping[str, Any], path: str) -> None:
        for name in node:
            if len(paths) > _SHOWN:
                return
            below = f"{path}/{name}" if path else str(name)
            child = node.get(name)
            if isinstance(child, Mapping) and below.count("/") < _DEEPEST:
                visit(child, below)
            elif _kind(child) in "fiuV":
                paths.append(below)

    visit(root, "")
    names = ", ".join(map(shown, paths[:_SHOWN]))
    return f"{names}{', …' if len(paths) > _SHOWN else ''}" or "none"
