"""How much memory a run takes, and how much there is: said before starting, not found out."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from .components.solver import HasMemory
from .errors import ConfigError, shown
from .grid import Grid

# In arrays of the grid's shape, eight bytes a cell. The peaks were measured on Linux with glibc.
# The indenter, and the operator with its transforms: those of a free boundary are padded.
_OPERATOR = {"free": 9.0, "periodic": 4.75}
# The same of a line of cells along x, whose transforms are twice as long and need tables.
_LINE = 14.0
# The solver active_set in full contact, and any that states nothing else (`HasMemory`).
_SOLVER = {"free": 17.4, "periodic": 11.5}
# A load step in the result: pressure, displacement, gap, and a byte that tells the contact.
_STEP = 3 + 1 / 8
# The same in the compressed image of the result file, in which steps are joined. It does not fit
# into the blocks that the solver has freed and malloc keeps.
_IMAGE = 2.3
# Buffers and Python's own objects [bytes].
_FIXED = 1e6

# Files of a control group: its limit, its usage, and the line of memory.stat with its file cache.
_VERSION_2 = "memory.max", "memory.current", "inactive_file"
_VERSION_1 = "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"


def estimate(grid: Grid, steps: int, solver: object = None) -> float:
    """Return the memory [bytes] that a run on ``grid`` needs at its peak, beside the libraries.

    It is that of the last solve, beside the steps before it and the image of their file. How much
    of the domain will be in contact is not known: full contact is assumed, which takes up to a
    quarter more than a small one. A ``solver`` that is no `HasMemory` counts as active_set.
    """
    try:
        cells = float(grid.points[0] * grid.points[1])
    except OverflowError:
        return math.inf
    operator = _LINE if grid.points[1] == 1 else _OPERATOR[grid.boundary]
    iterating = solver.arrays(grid) if isinstance(solver, HasMemory) else _SOLVER[grid.boundary]
    arrays = operator + iterating + (_STEP + _IMAGE) * (steps - 1)
    return _FIXED + 8 * cells * arrays


def available(root: Path = Path("/")) -> float | None:
    """Return the memory [bytes] that we can still have here, or None if the system does not say.

    That of the machine, or of the control groups of this process (containers, batch systems) where
    they leave less. ``root`` is the root of the file system.
    """
    return min(
        (there for there in (_of_machine(root), *_of_groups(root)) if there is not None),
        default=None,
    )


def _of_machine(root: Path) -> float | None:
    for line in _lines(root / "proc/meminfo"):
        if line.startswith("MemAvailable:"):
            return float(line.split()[1]) * 1024
    try:
        return float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):
        return None


def _of_groups(root: Path) -> Iterator[float | None]:
    """Yield what each control group that holds this process leaves, of version 2 and of 1."""
    for line in _lines(root / "proc/self/cgroup"):
        _, controllers, group = line.split(":", 2)
        if controllers == "":
            mount, names = root / "sys/fs/cgroup", _VERSION_2
        elif "memory" in controllers.split(","):
            mount, names = root / "sys/fs/cgroup/memory", _VERSION_1
        else:
            continue
        # A container may see its own group as the root, under the name that it has outside.
        inner = PurePosixPath(group.strip("/"))
        for folder in (inner, *inner.parents):
            yield _left(mount / folder, *names)


def _left(folder: Path, limit: str, usage: str, cache: str) -> float | None:
    """Return the limit of a group less what it uses, but for file cache that would be given up."""
    try:
        most, used = (float((folder / name).read_text()) for name in (limit, usage))
    except (OSError, ValueError):  # not there, not ours to read, or "max"
        return None
    kept = dict(line.split() for line in _lines(folder / "memory.stat"))
    return max(0.0, most - used + float(kept.get(cache, 0)))


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except OSError:
        return []


def require(grid: Grid, steps: int, solver: object = None) -> None:
    """Refuse a run that does not fit.

    Raises
    ------
    ConfigError
        The estimate is over what is available.
    """
    needed, there = estimate(grid, steps, solver), available()
    if there is not None and needed > there:
        nx, ny = grid.points
        raise ConfigError(
            f"{shown(nx)} × {shown(ny)} with {steps} step{'s' * (steps > 1)} needs about "
            f"{shortage(needed, there)}; use fewer points or fewer steps",
            "grid.points",
        )


def shortage(needed: float, there: float) -> str:
    """Return what a message says of memory [bytes] that is not there."""
    return f"{needed / 1e9:.3g} GB, and {there / 1e9:.3g} GB are available"
