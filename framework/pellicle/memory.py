"""The memory that is available to this process, and the refusal of a run that needs more."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path, PurePosixPath

from .errors import ConfigError
from .grid import Grid

PROCESS = 150_000_000
"""Memory of a process that has loaded pellicle and its libraries, without a run [bytes]."""


def available(root: Path = Path("/")) -> float | None:
    """Return the available memory [bytes], or None if the system does not state it.

    This is the memory available on the machine or, if less, in the control groups of this process
    (version 2; containers, batch systems). ``root`` is the root of the file system.
    """
    limits = [
        float(line.split()[1]) * 1024
        for line in _lines(root / "proc/meminfo")
        if line.startswith("MemAvailable:")
    ]
    if not limits:
        with suppress(AttributeError, ValueError, OSError):
            limits.append(float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE"))
    for group in _lines(root / "proc/self/cgroup"):
        # A container may see its own group as the root, although the file gives its outer name.
        inner = PurePosixPath(group.removeprefix("0::").strip("/"))
        for path in (inner, *inner.parents):
            folder = root / "sys/fs/cgroup" / path
            # A limit may be missing, not readable, or "max". The cache can be reclaimed.
            with suppress(OSError, ValueError):
                most = float((folder / "memory.max").read_text())
                used = float((folder / "memory.current").read_text())
                for line in _lines(folder / "memory.stat"):
                    used -= float(line.split()[1]) if line.startswith("inactive_file ") else 0.0
                limits.append(max(0.0, most - used))
    return min(limits, default=None)


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except OSError:
        return []


def require(needed: float, grid: Grid, steps: int) -> None:
    """Refuse a run that needs more memory [bytes] than is available."""
    subject = "{} × {}".format(*grid.points) + f" with {steps} step{'s' * (steps > 1)}"
    require_for(needed, subject, "use fewer points or fewer steps", "grid.points")


def require_for(needed: float, subject: str, remedy: str, field: str = "") -> None:
    """Refuse what needs more memory [bytes] than is available."""
    limit = available()
    if limit is not None and needed > limit:
        raise ConfigError(f"{subject} needs about {shortage(needed, limit)}; {remedy}", field)


def shortage(needed: float, limit: float) -> str:
    """Return a phrase with needed and available memory, both in bytes, for a message."""
    return f"{needed / 1e9:.3g} GB, and {limit / 1e9:.3g} GB are available"
