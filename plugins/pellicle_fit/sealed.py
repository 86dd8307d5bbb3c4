"""JSON files with a checksum of their content, so that one that was edited or cut is found."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from pellicle.errors import StorageError
from pellicle.files import atomic_write, json_text


def write_sealed(value: dict[str, Any], path: Path) -> Path:
    """Write ``value``, which is not empty, to a JSON file, and return its path."""
    text = json_text(value).encode("ascii")
    with atomic_write(path) as part:
        part.write_bytes(_head(text) + b"," + text[1:])
    return path


def read_sealed(path: Path) -> dict[str, Any]:
    """Return what `write_sealed` wrote.

    Raises
    ------
    StorageError
        The file cannot be read, or its content does not match its checksum.
    """
    try:
        head, _, rest = path.read_bytes().partition(b",")
    except OSError as error:
        raise StorageError(f"{path}: cannot be read ({error.strerror or error})") from None
    text = b"{" + rest
    if head != _head(text):
        raise StorageError(
            f"{path}: was changed after pellicle wrote it, or is damaged; restore it from a copy, "
            "or fit it again"
        )
    value: dict[str, Any] = json.loads(text)
    return value


def _head(text: bytes) -> bytes:
    return b'{\n  "checksum": "%s"' % hashlib.sha256(text).hexdigest().encode("ascii")
