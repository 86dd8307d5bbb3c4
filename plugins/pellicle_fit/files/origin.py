"""The origin of a curve: its file with its hash, the columns that were read, the calibration."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pellicle.errors import PellicleError, StorageError

if TYPE_CHECKING:
    from .measurement import Measurement


@dataclass(frozen=True)
class CurveOrigin:
    """Where a curve comes from; without a file it was given by its numbers."""

    file: str | None = None
    curve: str | None = None
    """Label of the curve in a file that holds several."""
    sha256: str | None = None
    """SHA-256 of the file."""
    columns: Mapping[str, str] = field(default_factory=dict)
    """Name and unit of the column in each role."""
    sensitivity: float | None = None
    """Deflection of the cantilever over the signal of its detector [m/V], if it was used."""
    library: str | None = None
    """Package that read the file, if it is not pellicle."""

    def to_dict(self) -> dict[str, Any]:
        """Return JSON data, in which nothing of the machine but the path appears."""
        return vars(self) | {"columns": dict(self.columns)}


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file in hexadecimal digits.

    Raises
    ------
    StorageError
        The file cannot be read.
    """
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise StorageError(f"{path}: cannot be read ({error.strerror or error})") from None


class Stamped(Mapping[str, "Measurement | PellicleError"]):
    """The curves of a file, each with the file's name and hash as its origin.

    Parameters
    ----------
    contents
        Curves, or the errors of reading them, by their labels.
    path
        Their file.
    state
        State of the file, from `state`, before it was read.

    Raises
    ------
    StorageError
        The file was replaced while it was read.
    """

    def __init__(
        self,
        contents: Mapping[str, Measurement | PellicleError],
        path: Path,
        state: tuple[int, ...],
    ) -> None:
        self._contents, self._path, self._state = contents, path, state
        self._sha256 = sha256(path)
        if self._changed():
            raise self._error()

    def _changed(self) -> bool:
        return state(self._path) != self._state

    def _error(self) -> StorageError:
        return StorageError(f"{self._path}: was changed while it was read; read it again")

    def __len__(self) -> int:
        return len(self._contents)

    def __iter__(self) -> Iterator[str]:
        return iter(self._contents)

    def __getitem__(self, label: str) -> Measurement | PellicleError:
        curve = self._contents[label]
        if isinstance(curve, PellicleError):
            return curve
        if self._changed():
            # Curves of force maps are read one by one.
            return self._error()
        origin = replace(
            curve.origin, file=str(self._path), curve=label or None, sha256=self._sha256
        )
        return replace(curve, origin=origin)


def state(path: Path) -> tuple[int, ...]:
    """Return numbers that change if a file is written or replaced; none if it cannot be read."""
    try:
        status = path.stat()
    except OSError:
        return ()
    return status.st_ino, status.st_size, status.st_mtime_ns
