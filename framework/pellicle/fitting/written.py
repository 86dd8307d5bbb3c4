"""Writes JSON files."""

from __future__ import annotations

import json
from pathlib import Path

from pellicle.files import atomic_write


def as_json(value: object) -> str:
    """Return JSON for people."""
    return json.dumps(value, indent=2, ensure_ascii=False) + "\n"


def write_json(value: object, path: Path) -> Path:
    """Write ``value`` to a file, in place of an old one, and return its name.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    with atomic_write(path) as part:
        part.write_text(as_json(value), encoding="utf-8")
    return path
