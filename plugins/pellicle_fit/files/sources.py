"""Measured curves from folders, files, patterns and tables of files."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from glob import glob, has_magic
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

from numpy.typing import ArrayLike

from pellicle.errors import ConfigError, PellicleError, all_problems
from pellicle.units import Quantity

from .columns import Calibration
from .measurement import Measurement, Readers, Segment, Site
from .readers import SUFFIXES, TEXT, read
from .text_table import FILE, read_cells

_ARRAYS = ("position", "force", "time")

Curves = str | Path | Sequence[str | Path] | Mapping[str, Sequence[ArrayLike]]
"""A folder, a file, a table that lists files, several of these; or arrays of curves by name:
position, force and perhaps time."""


class Source(NamedTuple):
    """One curve with its name, or the error of reading it."""

    name: str
    """File, and label in the file."""
    curve: Measurement | PellicleError
    fields: Mapping[str, Any]
    """Fields of the indenter that this curve alone has."""
    file: str = ""
    """The file, or the name of a curve that was given by its numbers."""
    group: str = ""
    """Text of the column of a table of files by which curves are grouped."""
    map: str = ""
    """File of the force map that the curve belongs to: its own, or the table of files."""

    def named(self, error: PellicleError, hint: str = "") -> ConfigError:
        """Return an error with the name of the source in front, once, and a hint at the end."""
        return ConfigError(f"{self.name}: {str(error).removeprefix(f'{self.name}: ')}{hint}")


def gather(
    curves: Curves,
    segment: str,
    calibration: Calibration,
    per_file: Mapping[str, Sequence[Any]],
    label: str = "",
    is_field: bool = False,
) -> Iterator[Source]:
    """Return all curves, in order, each read only as it is taken.

    Each list in ``per_file`` has one value for each file.  In a table that lists files, the columns
    x and y are the place on the sample, and the column ``label`` holds the group of each curve; it
    may be a field of the indenter as well.
    """
    files: list[tuple[Any, dict[str, str], Path | None]]
    if isinstance(curves, Mapping):
        files = [(name, {}, None) for name in curves]
    else:
        paths = [curves] if isinstance(curves, (str, Path)) else curves
        files = [file for text in paths for path in expanded(text) for file in _files(path)]
    if not files:
        raise ConfigError("holds no curve; give files, or a folder of them", "curves")
    for name, values in per_file.items():
        if len(values) != len(files):
            raise ConfigError(
                f"{len(values)} values for {len(files)} files; give one, or one for each file in "
                "order",
                name,
            )
    opened = []
    for number, (file, listed, table) in enumerate(files):
        group = listed.get(label.lower(), "")
        fields = {name: values[number] for name, values in per_file.items()}
        fields |= {name: v for name, v in listed.items() if is_field or name != label.lower()}
        whole = str(table or file) if {"x", "y"} <= fields.keys() else str(file)
        source = partial(Source, file=str(file), group=group, map=whole)
        numbers = curves[file] if isinstance(curves, Mapping) else None
        opened.append(_opened(file, source, fields, numbers, segment, calibration))
    return chain.from_iterable(opened)


def _opened(
    path: Any,
    source: Callable[..., Source],
    fields: dict[str, Any],
    numbers: Sequence[ArrayLike] | None,
    segment: str,
    calibration: Calibration,
) -> Iterator[Source]:
    """Yield the curves of a file, or the one called ``path`` that is given by ``numbers``."""
    settings = {
        name: fields.pop(name, getattr(calibration, name)) for name in Calibration.model_fields
    }
    readers: Readers
    site = None
    try:
        if {"x", "y"} <= fields.keys():
            with all_problems() as within, within("x and y"):
                site = Site(*(Quantity("m")(fields.pop(name)) for name in "xy"))
        calibration = Calibration(**settings)
        if numbers is None:
            readers = read(path, calibration, segment)
        else:
            # `clean` checks the arrays.
            arrays: Any = dict(zip(_ARRAYS, numbers, strict=False))
            arrays |= {"stiffness": calibration.spring_constant, "speed": calibration.speed}
            readers = {"": partial(Measurement, **arrays)}
    except PellicleError as error:
        yield source(str(path), error, fields)
        return
    for label, reader in readers.items():
        curve: Measurement | PellicleError
        try:
            curve = reader()
            curve = replace(curve, site=site or curve.site)
        except PellicleError as error:
            curve = error
        yield source(f"{path}:{label}" if label else str(path), curve, fields)


def expanded(pattern: str | Path, folder: str | Path = "") -> list[Path]:
    """Return the files that match a pattern such as ``"beads/*.csv"``; any other path as it is."""
    path = Path(folder, pattern)
    if path.exists() or not has_magic(str(pattern)):
        return [path]
    files = glob(str(pattern), root_dir=folder or None, recursive=True)
    if not files:
        raise ConfigError(f"{pattern}: matches no file; give files, or a folder of them", "curves")
    return sorted(Path(folder, file) for file in files)


def _files(path: Path) -> list[tuple[Path, dict[str, str], Path | None]]:
    """Return the files that a path stands for, each with its fields in a list of files, and that.

    A list is a table with a header such as ``file,radius [um]``; its empty cells are left out.
    """
    if path.is_dir():
        files = [file for file in sorted(path.glob("[!.]*")) if file.suffix.lower() in SUFFIXES]
        if not files:
            raise ConfigError(f"{path}: holds no file of a known kind ({', '.join(SUFFIXES)})")
        return [(file, {}, None) for file in files]
    cells = read_cells(path) if path.suffix.lower() in TEXT and path.is_file() else None
    if cells is None or FILE not in cells.names:
        return [(path, {}, None)]
    listed: list[tuple[Path, dict[str, str], Path | None]] = []
    named = [(name, head.unit) for name, head in zip(cells.names, cells.heads, strict=True)]
    for row in cells.rows:
        pairs = zip(named, map(str.strip, row), strict=False)
        fields = {name: f"{cell} {unit}".strip() for (name, unit), cell in pairs if cell and name}
        if FILE not in fields:
            raise ConfigError(f"{path}: has a row without a file; name one in each row")
        listed.append((path.parent / fields.pop(FILE), fields, path))
    return listed


def read_curves(
    path: str | Path, *, segment: Segment = "both", **calibration: Any
) -> dict[str, Measurement]:
    """Return the curves of a file, a folder, a pattern or a table of files by their names.

    Position, force and time are in SI; a curve draws itself with `Measurement.plot`.

    Parameters
    ----------
    path
        As the curves of `fit_many`.
    segment
        Segment of the files of instruments that label segments; both are all rows.
    **calibration
        Options of `fit` that say how files are read: ``spring_constant``, ``sensitivity``,
        ``speed``, ``columns``.

    Returns
    -------
    dict[str, Measurement]
        In order; a curve that cannot be read is left out with a warning.

    Raises
    ------
    ConfigError
        No curve can be read, or an argument is not allowed.
    StorageError
        A folder or a list of files cannot be read.
    """
    curves: dict[str, Measurement] = {}
    errors: list[PellicleError] = []
    for source in gather(path, segment, Calibration(**calibration), {}):
        if isinstance(source.curve, Measurement):
            curves[source.name] = source.curve
        else:
            errors.append(source.named(source.curve))
    if not curves:
        raise ConfigError("\n".join(map(str, errors)))
    for error in errors:
        warnings.warn(str(error), stacklevel=2)
    return curves
