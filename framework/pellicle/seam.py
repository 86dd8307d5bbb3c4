"""Whether a rough surface goes on across the edges of its period."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

from .grid import Grid

_STEEPER = 3.0


def warn_of_seam(heights: NDArray[np.float64], grid: Grid) -> None:
    """Warn where opposite edges of a periodic surface meet in a step.

    That is one whose rms is more than three times that between any two neighbouring lines of
    cells.  ``heights`` [m] are of the grid's shape.

    Warns
    -----
    UserWarning
        Says along which axis, and how high the step is.
    """
    if grid.boundary != "periodic" or not np.isfinite(heights).all():
        return
    for axis, name in enumerate("xy"):
        lines = np.moveaxis(heights, axis, 0)
        if len(lines) < 4:
            continue
        inside = float(np.sqrt((np.diff(lines, axis=0) ** 2).mean(axis=1)).max())
        step = float(np.sqrt(((lines[0] - lines[-1]) ** 2).mean()))
        if step > _STEEPER * inside:
            warnings.warn(
                f"the surface is no period along {name}: its edges meet in a step of {step:.2g} m "
                f"(rms), where neighbouring cells differ by {inside:.2g} m at most; press it on "
                'grid.boundary = "free", or make it periodic',
                stacklevel=3,
            )
