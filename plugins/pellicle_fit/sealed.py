"""JSON files with a checksum of their content, so that one that was edited or cut is found."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from pellicle.errors import StorageError
from pellicle.files import json_text, write_json


def write_sealed(value: dict[str, Any], path: Path) -> Path:
    """Write ``value`` and its checksum to a JSON file, and return its path."""
    return write_json({"checksum": _checksum(value), **value}, path)


def read_sealed(path: Path) -> dict[str, Any]:
    """Return what `write_sealed` wrote; for any other file it raises a StorageError."""
    try:
        value: dict[str, Any] = json.loads(path.read_bytes())
        if value.pop("checksum") == _checksum(value):
            return value
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError):
        pass
    raise StorageError(f"{path}: is missing, or was changed since pellicle wrote it; fit again")


def _checksum(value: dict[str, Any]) -> str:
    return hashlib.sha256(json_text(value).encode("ascii")).hexdigest()
