"""Measured curves from folders, files, patterns and tables of files."""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from glob import glob, has_magic
from os.path import exists
from pathlib import Path
from typing import Any, NamedTuple

from numpy.typing import ArrayLike

from pellicle.errors import ConfigError, PellicleError, all_problems
from pellicle.files import is_file, is_folder
from pellicle.units import Quantity

from .choice import TEXT, has_known_suffix, is_read, read, suffixes
from .columns import Calibration
from .measurement import CurvesByLabel, Measurement, Site
from .text_table import FILE, read_list

PLACE = ("x", "y")
"""Columns of a table of files: where on the sample a curve was measured."""

Curves = str | Path | Sequence[str | Path] | Mapping[str, Sequence[ArrayLike]]
"""A folder, a file, a table that lists files, several of these; or arrays of curves by name:
position, force and perhaps time."""


class Source(NamedTuple):
    """One curve with its name, or the error of reading it."""

    name: str
    """File, and label in the file."""
    curve: Measurement | PellicleError
    fields: Mapping[str, Any]
    """What ``per_file`` or its row of a table of files says of it, by name."""
    file: str = ""
    """The file, or the name of a curve that was given by its numbers."""
    label: str = ""
    """What tells it from others in the file."""
    map: str = ""
    """File of the force map that the curve belongs to: its own, or the table of files."""
    total: int = 0
    """Number of all curves, of files that were not opened yet one each; 0 if it is not known."""

    def with_name(self, error: PellicleError, hint: str = "") -> ConfigError:
        """Return an error with the name of the source in front, once, and a hint at the end."""
        return ConfigError(f"{self.name}: {self.reason(error)}{hint}")

    def reason(self, error: Exception) -> str:
        """Return what an error says, without file and curve, with which readers begin."""
        text = str(error).removeprefix(f"{self.file}: ").removeprefix(f"curve {self.label}: ")
        return text.removeprefix(f"{self.name}: ")


def gather(
    curves: Curves, calibration: Calibration, per_file: Mapping[str, Sequence[Any]]
) -> Iterator[Source]:
    """Yield all curves, in order, each read only as it is taken.

    Each list in ``per_file`` has one value for each file.  In a table that lists files, the columns
    x and y are the place on the sample.
    """
    listed, opened = [*_listed(curves, per_file, calibration.columns or {})], 0
    for number, (file, fields, table) in enumerate(listed, 1):
        site: Site | None = None
        readers: CurvesByLabel = {}
        origin: dict[str, Any] = {}
        source = partial(Source, fields=fields, file=str(file))
        try:
            if not fields.keys().isdisjoint(PLACE):
                with all_problems() as within, within("x and y"):
                    site = Site(*(Quantity("m")(fields.get(name)) for name in PLACE))
            known = dict(calibration) | fields
            own = Calibration(**{name: known[name] for name in Calibration.model_fields})
            if isinstance(curves, Mapping):
                # `clean` checks the arrays.
                arrays: Any = dict(zip(("position", "force", "time"), curves[file], strict=False))
                arrays |= {"stiffness": own.spring_constant, "speed": own.speed}
                readers = {"": partial(Measurement, **arrays)}
            else:
                readers = read(file, own)
                with file.open("rb") as content:
                    digest = hashlib.file_digest(content, "sha256").hexdigest()
                origin = {"file": str(file), "sha256": digest}
        except PellicleError as error:
            yield source(str(file), error)
        opened += len(readers) or 1
        for label, reader in readers.items():
            curve: Measurement | PellicleError
            try:
                curve = reader()
                of_curve = curve.origin._replace(curve=label or None, **origin)
                curve = replace(curve, site=site or curve.site, origin=of_curve)
            except PellicleError as error:
                curve = error
            name = f"{file}:{label}" if label else str(file)
            total = opened + len(listed) - number
            yield source(name, curve, label=label, map=str(table if site else file), total=total)


def _listed(
    curves: Curves, per_file: Mapping[str, Sequence[Any]], mapped: Mapping[str, str]
) -> Iterator[tuple[Any, dict[str, Any], Any]]:
    """Yield files, or the names of arrays, each with its fields and the table that lists it."""
    files: list[tuple[Any, dict[str, str], Any]]
    if isinstance(curves, Mapping):
        files = [(name, {}, name) for name in curves]
    else:
        paths = [curves] if isinstance(curves, (str, Path)) else curves
        expanded_paths = [path for text in paths for path in expand_pattern(text)]
        files = [file for path in expanded_paths for file in _files(path, mapped)]
    if not files:
        raise ConfigError("holds no curve; give files, or a folder of them", "curves")
    for name, values in per_file.items():
        if len(values) != len(files):
            raise ConfigError(
                f"{len(values)} values for {len(files)} files; give one, or one for each file in "
                "order",
                name,
            )
    for number, (file, listed, table) in enumerate(files):
        yield file, {name: values[number] for name, values in per_file.items()} | listed, table


def expand_pattern(pattern: str | Path, folder: str | Path = "") -> list[Path]:
    """Return the files that match a pattern such as ``"beads/*.csv"``; any other path as it is."""
    path = Path(folder, pattern)
    if exists(path) or not has_magic(str(pattern)):
        return [path]
    files = glob(str(pattern), root_dir=folder or None, recursive=True)
    if not files:
        raise ConfigError(f"{pattern}: matches no file; give files, or a folder of them", "curves")
    return sorted(Path(folder, file) for file in files)


def _files(path: Path, mapped: Mapping[str, str]) -> list[tuple[Path, dict[str, str], Path]]:
    """Return the files that a path stands for, each with its fields in a list of files, and that.

    A list is a table with a header such as ``file,radius [um]``, in whose rows a file, a folder or
    a pattern exists, or all of whose files have the suffix of a curve; its empty cells are left
    out.
    """
    if is_folder(path):
        return [(file, {}, file) for file in _in_folder(path)]
    is_table = path.suffix.lower() in TEXT and is_file(path)
    rows = read_list(path, mapped) if is_table else []
    listed = [(name, row) for row in rows if (name := row.pop(FILE, ""))]
    paths = [path.parent / name for name, _ in listed]
    is_list = bool(paths) and all(map(has_known_suffix, paths))
    if not is_list and not any(exists(p) or (has_magic(str(p)) and glob(str(p))) for p in paths):
        return [(path, {}, path)]
    if len(listed) < len(rows):
        raise ConfigError(f"{path}: has a row without a file; name one in each row")
    return [
        (file, fields, path)
        for name, fields in listed
        for one in expand_pattern(name, path.parent)
        for file in (_in_folder(one) if is_folder(one) else [one])
    ]


def _in_folder(folder: Path) -> list[Path]:
    """Return the files with curves in a folder, without those in its folders."""
    entries = sorted(folder.glob("[!.]*"))
    if files := [file for file in entries if is_read(file)]:
        return files
    of = next(
        (f"; give its folders, {entry.parent}/*" for entry in entries if is_folder(entry)), ""
    )
    raise ConfigError(f"{folder}: holds no file of a known kind ({', '.join(suffixes())}){of}")


def read_curves(path: str | Path, **calibration: Any) -> dict[str, Measurement]:
    """Return the curves of a file, a folder, a pattern or a table of files by their names.

    Position, force and time are in SI; a curve draws itself with `Measurement.plot`.

    Parameters
    ----------
    path
        As the curves of `fit_many`.
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
    for source in gather(path, Calibration(**calibration), {}):
        if isinstance(source.curve, Measurement):
            curves[source.name] = source.curve
        else:
            errors.append(source.with_name(source.curve))
    if not curves:
        raise ConfigError("\n".join(map(str, errors)))
    for error in errors:
        warnings.warn(str(error), stacklevel=2)
    return curves
