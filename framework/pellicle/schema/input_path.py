"""Paths of input files, relative to the file that names them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Annotated, Final

from pydantic import AfterValidator, PlainSerializer, SerializationInfo

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


PORTABLE: Final = "portable"
"""Context of ``model_dump`` that writes the names of files without their folders."""


def _from_folder(path: Path) -> Path:
    folder = _folder.get()
    return path if folder is None else (folder / path).absolute()


def _written(path: Path, info: SerializationInfo) -> Path | str:
    if info.context == PORTABLE:
        return path.name
    return str(path) if info.mode_is_json() else path


InputPath = Annotated[Path, AfterValidator(_from_folder), PlainSerializer(_written)]
"""An input file; in a TOML file, relative to that file."""
