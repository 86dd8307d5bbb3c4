"""Writes JSON files."""

from __future__ import annotations

import json
from pathlib import Path

from pellicle.storage import aside


def write_json(value: object, path: Path) -> Path:
    """Write ``value`` to a file, in place of an old one, and return its name.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    with aside(path) as part:
        text = json.dumps(value, indent=2, ensure_ascii=False)
        part.write_text(f"{text}\n", encoding="utf-8")
    return path
