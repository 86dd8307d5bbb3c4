"""The curves of folders, files and lists of files, each with what is its own of the indenter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.errors import ConfigError, PellicleError

from .columns import Calibration, Measured
from .readers import SUFFIXES, Found, manifest, read

Curves = str | Path | Sequence[str | Path] | Mapping[str, tuple[ArrayLike, ArrayLike]]
"""A folder, a file, a table that lists files, several of these; or position and force by name."""
_CALIBRATION = ("spring_constant", "sensitivity")


@dataclass(frozen=True)
class Source:
    """One curve, or why there is none."""

    name: str
    """File, and label in it."""
    curve: Measured | PellicleError
    fields: Mapping[str, Any]
    """Of the indenter."""

    def reason(self, error: Exception) -> str:
        """Return an error without the name of the source, where it begins with it."""
        return str(error).removeprefix(f"{self.name}: ")

    def named(self, error: ConfigError, hint: str = "") -> ConfigError:
        """Return an error that names the source, and a hint what to do."""
        return ConfigError(f"{self.name}: {self.reason(error)}{hint}")


def gather(curves: Curves, segment: str, fields: Mapping[str, Any]) -> list[Source]:
    """Return all curves, in order.

    A value in ``fields`` that is a list has one for each file (or each curve that is given by its
    numbers).  ``spring_constant`` and ``sensitivity`` among them go to the reader.

    Raises
    ------
    ConfigError
        There is no curve, or a list of values is of another length than that of the files.
    StorageError
        A folder or a list of files cannot be read.
    """
    if isinstance(curves, Mapping):
        given: list[tuple[Any, dict[str, Any]]] = [(name, {}) for name in curves]
    else:
        paths = [curves] if isinstance(curves, (str, Path)) else curves
        given = [each for path in paths for each in _files(Path(path))]
    if not given:
        raise ConfigError("holds no curve; give files, or a folder of them", "curves")
    sources = []
    for (of, listed), own in zip(given, _each(fields, len(given)), strict=True):
        merged = own | listed
        try:
            calibration = Calibration.of(*(merged.pop(name, None) for name in _CALIBRATION))
            found: Found = (
                {"": _arrays(*curves[of], calibration)}
                if isinstance(curves, Mapping)
                else read(of, calibration, segment)
            )
        except PellicleError as error:
            found = {"": error}
        for label, curve in found.items():
            sources.append(Source(f"{of}:{label}" if label else str(of), curve, merged))
    return sources


def _files(path: Path) -> list[tuple[Path, dict[str, str]]]:
    """Return the files that a path stands for, each with what a list says of it."""
    if path.is_dir():
        found = sorted(
            each
            for each in path.iterdir()
            if each.suffix.lower() in SUFFIXES and not each.name.startswith(".")
        )
        if not found:
            raise ConfigError(f"{path}: holds no file of a known kind ({', '.join(SUFFIXES)})")
        return [(each, {}) for each in found]
    if not path.is_file() or (rows := manifest(path)) is None:
        return [(path, {})]
    if not all("file" in row for row in rows):
        raise ConfigError(f"{path}: has a row without a file; name one in each row")
    return [(path.parent / row.pop("file"), row) for row in rows]


def _each(fields: Mapping[str, Any], count: int) -> list[dict[str, Any]]:
    """Return the fields of each file."""
    for name, value in fields.items():
        if isinstance(value, (list, tuple)) and len(value) != count:
            raise ConfigError(
                f"{len(value)} values for {count} files; give one, or one for each file in order",
                name,
            )
    return [
        {k: v[at] if isinstance(v, (list, tuple)) else v for k, v in fields.items()}
        for at in range(count)
    ]


def _arrays(position: ArrayLike, force: ArrayLike, calibration: Calibration) -> Measured:
    # `clean` says what is wrong with it.
    return Measured(
        cast("Array", force), cast("Array", position), stiffness=calibration.spring_constant
    )
