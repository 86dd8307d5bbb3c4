"""Curves in files that hold named arrays in folders: HDF5 and MATLAB."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConfigError, StorageError, shown
from pellicle.schema import read_mat

from .columns import Channel
from .roles import NAMES, role_of

if TYPE_CHECKING:
    import h5py

_ANY = "*"
_SHOWN = 8
"""Largest number of arrays that a message names."""
_DEEPEST = 8
"""Largest depth of folders that a message describes; links can make circles."""


def read_hdf5(path: Path, mapped: Mapping[str, str]) -> dict[str, Mapping[str, Channel]]:
    """Return the columns of each curve of an HDF5 file by its label.

    Raises
    ------
    StorageError
        The file cannot be read.
    ConfigError
        A path in ``mapped`` leads to no array of numbers.
    """
    import h5py

    try:
        with h5py.File(path) as file:
            if mapped:
                return _mapped(path, file, mapped)
            if columns := _standard_columns(file):
                return {"": columns}
            groups = {
                str(name): _standard_columns(group)
                for name, group in file.items()
                if isinstance(group, h5py.Group)
            }
    except (OSError, RuntimeError) as error:
        reason = getattr(error, "strerror", "") or error
        raise StorageError(f"{path}: cannot be read as an HDF5 file ({reason})") from None
    return {name: columns for name, columns in groups.items() if columns} or {"": {}}


def read_matlab(path: Path, mapped: Mapping[str, str]) -> dict[str, Mapping[str, Channel]]:
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
    return _mapped(path, content, mapped)


def _standard_columns(group: h5py.Group) -> dict[str, Channel]:
    """Return the columns with known names that are datasets of a group."""
    import h5py

    columns = {}
    for name in NAMES:
        dataset = group.get(name)
        if isinstance(dataset, h5py.Dataset) and dataset.ndim == 1 and dataset.dtype.kind in "fiu":
            columns[name] = Channel(_unit(dataset), np.asarray(dataset, dtype=float))
    return columns


def _unit(array: Any) -> str:
    attributes = getattr(array, "attrs", {})
    unit = next((attributes[name] for name in ("units", "unit") if name in attributes), "")
    return unit.decode() if isinstance(unit, bytes) else str(unit)


def _mapped(path: Path, root: Any, mapped: Mapping[str, str]) -> dict[str, Mapping[str, Channel]]:
    """Return the arrays whose paths are ``mapped``, by the labels of their curves."""
    channels: dict[str, dict[str, Channel]] = {}
    for pattern, text in mapped.items():
        role = role_of(text)
        arrays = channels.setdefault(role.name, {})
        for label, array in _leaves(root, _parts(root, pattern)):
            for row, values in _rows(array, first=not hasattr(root, "filename")):
                whole = "/".join(filter(None, (label, row)))
                arrays[whole] = Channel(role.unit or _unit(array), values, pattern)
        if not arrays:
            raise ConfigError(
                f"{path}: has no array of numbers at {pattern!r} (it has {_content(root)})",
                "columns",
            )
    labels = max(channels.values(), key=len)
    curves: dict[str, Mapping[str, Channel]] = {}
    for label in labels:
        # An array that all curves share, such as the time, has no label.
        columns = {role: own.get(label, own.get("")) for role, own in channels.items()}
        if missing := [role for role, column in columns.items() if column is None]:
            raise ConfigError(f"{path}: curve {label} has no {missing[0]}", "columns")
        curves[label] = {role: column for role, column in columns.items() if column is not None}
    return curves


def _parts(root: Any, pattern: str) -> list[str]:
    """Return the names along a path; its separators are slashes or points."""
    parts = pattern.strip("/").split("/")
    return parts if len(parts) > 1 or parts[0] in root else parts[0].split(".")


def _leaves(node: Any, parts: list[str], label: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the arrays at a path, each with the names that stand for its ``*``."""
    if not parts:
        if getattr(getattr(node, "dtype", None), "kind", "") in tuple("fiu"):
            yield label, node
        return
    part, *rest = parts
    if isinstance(node, Mapping):
        if part == _ANY:
            for name in node:
                yield from _leaves(node.get(name), rest, f"{label}/{name}" if label else str(name))
        else:
            # A link of an HDF5 file may lead nowhere.
            yield from _leaves(node.get(part), rest, label)
    elif part in (getattr(getattr(node, "dtype", None), "names", None) or ()):
        yield from _leaves(node[part], rest, label)


def _rows(array: Any, *, first: bool) -> Iterator[tuple[str, Array]]:
    """Yield the curves of an array, each with its number if there are several.

    The points of a curve are along the ``first`` axis, or else along the last.
    """
    values = np.asarray(array, dtype=float)
    if values.squeeze().ndim <= 1:
        yield "", values.ravel()
        return
    values = np.moveaxis(values, 0, -1) if first else values
    for index in np.ndindex(values.shape[:-1]):
        yield ",".join(map(str, index)), values[index]


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
            elif getattr(getattr(child, "dtype", None), "kind", "") in tuple("fiuV"):
                paths.append(below)

    visit(root, "")
    names = ", ".join(shown(path) for path in paths[:_SHOWN])
    return f"{names}{', …' if len(paths) > _SHOWN else ''}" or "none"
