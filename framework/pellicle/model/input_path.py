"""Paths of input files, relative to the file that names them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import PlainSerializer, SerializationInfo, ValidatorFunctionWrapHandler, WrapValidator

_folder: ContextVar[Path | None] = ContextVar("folder", default=None)


@contextmanager
def paths_relative_to(folder: Path | None) -> Iterator[None]:
    """Resolve relative paths in a configuration against ``folder``, the folder of its file.

    None stands for the folder of the file being read or, without one, the current folder.
    """
    token = _folder.set(folder or _folder.get() or Path.cwd())
    try:
        yield
    finally:
        _folder.reset(token)


AS_GIVEN: Final = "as_given"
"""Context of ``model_dump`` that writes paths as the user gave them instead of absolute."""


# Before Python 3.12, pathlib.Path itself cannot be subclassed.
class _GivenPath(type(Path())):  # type: ignore[misc]
    """A path that remembers the text that the user wrote."""

    given = ""

    def __reduce__(self) -> tuple[Any, ...]:
        return _given_path, (str(self), self.given)


def _given_path(path: str | Path, given: str) -> Path:
    result = _GivenPath(path)
    result.given = given
    return result


def as_given(path: Path) -> str:
    """Return a path as the user wrote it."""
    return getattr(path, "given", "") or str(path)


def _from_folder(value: Any, read: ValidatorFunctionWrapHandler) -> Path:
    if isinstance(value, _GivenPath):
        return value
    path, folder = read(value), _folder.get()
    return _given_path(path if folder is None else (folder / path).absolute(), str(path))


def _written(path: Path, info: SerializationInfo) -> Path | str:
    if info.context == AS_GIVEN:
        return as_given(path)
    return str(path) if info.mode_is_json() else path


InputPath = Annotated[Path, WrapValidator(_from_folder), PlainSerializer(_written)]
"""An input file; in a TOML file, relative to that file."""
