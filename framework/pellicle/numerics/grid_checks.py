"""Whether cells of a free boundary are narrow enough for a kernel, said before solving.

There the pressure is uniform in each cell and the displacement taken at its centre. A wave
p = cos qx, sampled so, holds the waves q + 2πm/Δ too, and all of them look alike at the centres.
Of the kernel G(q) the cells make

    Σ_m (−1)^m sin(qΔ/2) / (qΔ/2 + πm) G(|q + 2πm/Δ|),

which is G(q) to some per mille where G falls with q. An incompressible layer on a rigid base yields
the less the longer the wave: cells wider than it is thick have it yield by what it does not.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable

import numpy as np

from pellicle.arrays import Array
from pellicle.grid import Grid

_WAVE = 16  # cells
_ALIASES = 200  # to either side; the sum is good to about 1e-5
_ALLOWED = 0.03
_FINER = 1.25
_FINEST = 100.0  # times as many points each way are tried before none is recommended


def error_of_cells(compliance: Callable[[Array], Array], spacing: float) -> float:
    """Return by what share cells of width ``spacing`` [m] yield too much to a wave of 16 cells.

    ``compliance`` is G(q) [m/Pa] for q > 0 [rad/m]. It is NaN if that has no finite values.
    """
    orders = np.arange(-_ALIASES, _ALIASES + 1)
    phase = np.pi / _WAVE + np.pi * orders
    with np.errstate(all="ignore"):
        values = np.asarray(compliance(np.abs(2 * phase / spacing)), dtype=np.float64)
        weights = np.where(orders % 2, -1.0, 1.0) * np.sin(np.pi / _WAVE) / phase
        made = (weights * values).sum() / np.broadcast_to(values, phase.shape)[_ALIASES]
    return float(made) - 1.0


def warn_of_cells(compliance: Callable[[Array], Array], grid: Grid) -> None:
    """Warn where the cells of a free boundary are too wide for results to some per cent.

    Warns
    -----
    UserWarning
        Says how wrong results are likely to be, and how many points it takes.
    """
    if grid.boundary != "free":
        return
    errors = [error_of_cells(compliance, spacing) for spacing in grid.spacing]
    error = max(errors, key=lambda each: abs(each) if math.isfinite(each) else 0.0)
    if not abs(error) > _ALLOWED:
        return
    warnings.warn(
        f"grid.points: cells of {grid.spacing[0]:.3g} × {grid.spacing[1]:.3g} m yield to long "
        f"waves by {abs(error):.0%} {'more' if error > 0 else 'less'} than the kernel says, and "
        "forces are likely to be as wrong; an incompressible layer needs cells no wider than it is "
        f"thick: use {_enough(compliance, grid)}",
        stacklevel=3,
    )


def _enough(compliance: Callable[[Array], Array], grid: Grid) -> str:
    """Return in words how many points it takes."""
    factor = 1.0
    while (factor := factor * _FINER) < _FINEST:
        if all(abs(error_of_cells(compliance, d / factor)) <= _ALLOWED for d in grid.spacing):
            nx, ny = (math.ceil(n * factor) for n in grid.points)
            return f"about {nx} × {ny} points"
    return "more points"


_STEEPER = 3.0


def warn_of_seam(heights: Array, grid: Grid) -> None:
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
