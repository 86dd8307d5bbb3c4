"""What is asked of a file of heights before it is read."""

from __future__ import annotations

from pathlib import Path

from pellicle import memory
from pellicle.errors import ConfigError
from pellicle.files import is_file

_POINTS_PER_BYTE = 1032
"""Largest ratio at which deflate, used by HDF5, zip and gzip, compresses equal bytes."""


def require_file(path: Path) -> int:
    """Return the length of a file [bytes]; refuse one that is missing or empty."""
    if not is_file(path):
        raise ConfigError(f"{path}: no such file; give the file that holds the heights", "path")
    if length := path.stat().st_size:
        return length
    raise ConfigError(f"{path} is empty; give a file that holds a 2-D array", "path")


def require_content(points: int, path: Path) -> None:
    """Check that the bytes of a file can hold the points of its header, compressed or not."""
    length = path.stat().st_size
    if points > _POINTS_PER_BYTE * length:
        raise ConfigError(
            f"{path} claims {points} points, more than its {length} bytes can hold: it is damaged "
            "or incomplete; export it again",
            "path",
        )


def require_memory(needed: float, subject: str, remedy: str, field: str) -> None:
    """Check that the available memory [bytes] suffices; the error names ``field``."""
    available = memory.available()
    if available is not None and needed > available:
        shortage = memory.shortage(needed, available)
        raise ConfigError(f"{subject} needs about {shortage}; {remedy}", field)
