"""Paths of files to read, as their run file gives them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import (
    PlainSerializer,
    SerializationInfo,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)

_folder: ContextVar[Path | None] = ContextVar("folder", default=None)


@contextmanager
def paths_relative_to(folder: Path | None) -> Iterator[None]:
    """Read relative paths in a configuration as seen from ``folder``, where its file lies.

    With None, as seen from the current folder if no file is being read, and made absolute.
    """
    token = _folder.set(folder or _folder.get() or Path.cwd())
    try:
        yield
    finally:
        _folder.reset(token)


AS_GIVEN: Final = "as_given"
"""Context of ``model_dump`` in which paths are written as their file has them, not absolute."""


# Before Python 3.12 only the class of this system's paths can be derived from.
class _GivenPath(type(Path())):  # type: ignore[misc]
    """A path that knows how the user wrote it."""

    given = ""

    def __reduce__(self) -> tuple[Any, ...]:
        return _given_path, (str(self), self.given)


def _given_path(path: str | Path, given: str) -> Path:
    remembering = _GivenPath(path)
    remembering.given = given
    return remembering


def as_given(path: Path) -> str:
    """Return a path as the user wrote it, who may have moved its folder since."""
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
"""A file to read; in a TOML file, relative to that file."""
