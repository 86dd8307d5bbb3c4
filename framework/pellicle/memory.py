"""How much memory a run takes, and how much there is: said before starting, not found out."""

from __future__ import annotations

import math
import os
from pathlib import Path

from .errors import ConfigError, shown
from .grid import Grid

# Peak of a run with all outputs in float64 arrays: a tenth to a third above what was measured at
# N = 1024 with one step and four (free 24.9 and 49.9 arrays of N², periodic 19.3 and 42.9).
_PADDED_ARRAYS = 4
_CELL_ARRAYS = 9
_ARRAYS_PER_STEP = 9


def estimate(grid: Grid, steps: int) -> float:
    """Return the memory [bytes] that a run on ``grid`` needs at its peak."""
    try:
        cells = float(grid.points[0] * grid.points[1])
    except OverflowError:
        return math.inf
    padded = 4 * cells if grid.boundary == "free" else cells
    return 8 * (_PADDED_ARRAYS * padded + (_CELL_ARRAYS + _ARRAYS_PER_STEP * steps) * cells)


def available() -> float | None:
    """Return the memory [bytes] that this machine can still give, or None if it does not say."""
    meminfo = Path("/proc/meminfo")
    if meminfo.is_file():
        for line in meminfo.read_text(encoding="ascii").splitlines():
            if line.startswith("MemAvailable:"):
                return float(line.split()[1]) * 1024
    try:
        return float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):
        return None


def require(grid: Grid, steps: int) -> None:
    """Refuse a run that does not fit.

    Raises
    ------
    ConfigError
        The estimate is over what is available.
    """
    needed, there = estimate(grid, steps), available()
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
