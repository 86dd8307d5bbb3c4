"""Files: written whole or not at all, and texts in whatever encoding a stranger used."""

from __future__ import annotations

import codecs
import os
import re
import socket
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .errors import StorageError

# The longer marks first: that of UTF-32 begins with that of UTF-16.
_MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF32_LE: "utf-32",
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}


# Neither XML nor HTML allows them; line feeds and tabs it does.
_NOT_IN_DOCUMENTS = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")


def for_document(text: str) -> str:
    """Return a text with a replacement character for each that no document may hold."""
    return _NOT_IN_DOCUMENTS.sub("\ufffd", text)


def read_text(path: Path) -> str:
    """Return a text in UTF-8, in UTF-16 or UTF-32 with their mark, or in Windows' code page 1252.

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        It is not text.
    """
    content = path.read_bytes()
    encoding = next((_MARKS[mark] for mark in _MARKS if content.startswith(mark)), None)
    try:
        text = content.decode(encoding or "utf-8")
    except UnicodeDecodeError:
        if encoding is not None:
            raise
        # Instruments write µ, ° and ² so, and any other file of one byte a letter passes as this.
        text = content.decode("cp1252")
    if "\0" in text:
        raise ValueError("it holds bytes that are not text")
    return text


def check_writable(path: Path) -> None:
    """Find out before computing whether a file can be written at ``path``.

    What processes that have died left half-written in its folder is removed.

    Raises
    ------
    StorageError
        It cannot.
    """
    with storage_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path.parent):
            pass
        for part in path.parent.glob(".*.part"):
            made_by = re.search(r"\.([^.]+)\.(\d+)\.part$", part.name)
            if made_by and made_by[1] == _host() and not _alive(int(made_by[2])):
                part.unlink(missing_ok=True)


@contextmanager
def storage_errors(path: Path) -> Iterator[None]:
    """Turn a failure to write ``path`` into a StorageError that says what to do."""
    try:
        yield
    except OSError as error:
        raise StorageError(
            f"{path}: cannot be written ({error.strerror or error}); choose another folder"
        ) from None


@contextmanager
def atomic_write(path: Path) -> Iterator[Path]:
    """Yield a name to write to; rename it to ``path`` when whole, leave nothing when not."""
    part = path.with_name(f".{path.name}.{_host()}.{os.getpid()}.part")
    with storage_errors(path):
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            yield part
            with part.open("rb+") as file:
                os.fsync(file.fileno())
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)


def _host() -> str:
    return socket.gethostname().replace(".", "-")


def _alive(pid: int) -> bool:
    """Whether a process of this machine lives; on Windows, where asking would end it, yes."""
    if os.name == "nt":
        return True
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        pass
    return True
