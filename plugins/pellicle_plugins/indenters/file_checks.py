"""What is asked of a file of heights before it is read."""

from __future__ import annotations

from pathlib import Path

from pellicle import memory
from pellicle.errors import ConfigError
from pellicle.files import is_file


def require_file(path: Path) -> None:
    """Refuse a file that is missing or empty."""
    if not is_file(path):
        raise ConfigError(f"{path}: no such file; give the file that holds the heights", "path")
    if not path.stat().st_size:
        raise ConfigError(f"{path} is empty; give a file that holds a 2-D array", "path")


def require_memory(needed: float, subject: str) -> None:
    """Check that the available memory [bytes] suffices to read what a file holds."""
    available = memory.available()
    if available is not None and needed > available:
        shortage = memory.shortage(needed, available)
        raise ConfigError(f"{subject} needs about {shortage}; export a part of it", "path")
