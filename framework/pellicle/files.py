"""Write files atomically, read texts in the usual encodings, and fit texts for documents."""

from __future__ import annotations

import codecs
import glob
import json
import os
import re
import socket
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from .errors import StorageError

_MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
# XML refuses these characters, but for 0x7F to 0x9F, which are errors in HTML.
_NOT_IN_DOCUMENTS = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
_WHOLE, _FEW = re.compile(r"[-+]?\d+"), 4
"""A whole number, and the least number of different ones that may be decimals."""


# In a closed folder they return False, where the methods of `Path` raise before Python 3.14.
is_file, is_folder = os.path.isfile, os.path.isdir


def for_document(text: str) -> str:
    """Return a text with U+FFFD in place of characters that documents may not contain."""
    return _NOT_IN_DOCUMENTS.sub("\ufffd", text)


def read_text(path: Path) -> str:
    """Read a text in UTF-8, in UTF-16 with a byte order mark, or in code page 1252."""
    content = path.read_bytes()
    encoding = next((_MARKS[mark] for mark in _MARKS if content.startswith(mark)), None)
    try:
        text = content.decode(encoding or "utf-8")
    except UnicodeDecodeError:
        if encoding is not None:
            raise
        # Instruments write µ, ° and ² in code page 1252; other one-byte encodings mostly pass, too.
        text = content.decode("cp1252")
    if "\0" in text:
        raise ValueError("it holds bytes that are not text")
    return text


def fault_of_commas(rows: Iterable[Sequence[str]]) -> str:
    """Return what to do with a table whose commas may be decimal and separate columns, too.

    It has whole numbers alone, in turn those before and after a decimal comma. Those after it have
    no sign, and one length that the others have not or zeros in front.
    """
    lengths: tuple[set[int], set[int]] = set(), set()
    few, is_led = set[str](), False
    for cells in rows:
        wholes, decimals = cells[::2], cells[1::2]
        if len(wholes) != len(decimals) or not all(map(_WHOLE.fullmatch, wholes)):
            return ""
        if not all(map(str.isdecimal, decimals)):
            return ""
        is_led = is_led or any(cell[0] == "0" < cell for cell in decimals)
        few.update(decimals if len(few) < _FEW else ())
        for of, part in zip(lengths, (wholes, decimals), strict=True):
            of.update(len(cell.lstrip("+-")) for cell in part)
    if len(few) < _FEW or not (is_led or (len(lengths[1]) == 1 and lengths[0] != lengths[1])):
        return ""
    return (
        "has whole numbers alone, each second of which looks like decimals: commas may separate "
        "its columns and its decimals too; export it with decimal points"
    )


def check_writable(path: Path) -> None:
    """Check before computing that a file can be written at ``path``, and make its folder.

    The caller has locked the file: parts that a process left that was killed are removed.
    """
    with storage_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path.parent):
            pass
        for part in path.parent.glob(f".{glob.escape(path.name)}.*.part"):
            part.unlink(missing_ok=True)


@contextmanager
def storage_errors(path: Path) -> Iterator[None]:
    """Turn an OSError on writing ``path`` into a StorageError that names the remedy."""
    try:
        yield
    except OSError as error:
        raise StorageError(
            f"{path}: cannot be written ({error.strerror or error}); choose another folder"
        ) from None


@contextmanager
def atomic_write(path: Path) -> Iterator[Path]:
    """Yield a temporary path, which is renamed to ``path`` on success and removed on failure."""
    host = socket.gethostname().replace(".", "-")
    part = path.with_name(f".{path.name}.{host}.{os.getpid()}.part")
    with storage_errors(path):
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            yield part
            with part.open("rb+") as file:
                os.fsync(file.fileno())
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)


def json_text(value: object) -> str:
    """Return indented JSON in ASCII, which every terminal and code page contains."""
    return json.dumps(value, indent=2) + "\n"


def write_json(value: object, path: Path) -> Path:
    """Write ``value`` to a JSON file, which replaces an old one, and return its path."""
    with atomic_write(path) as part:
        part.write_text(json_text(value), encoding="utf-8")
    return path
