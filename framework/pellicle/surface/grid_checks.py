"""Warnings about a grid: cells too wide for the kernel, a surface that is not periodic.

On a free boundary the pressure is uniform in each cell and the displacement is taken at its centre.
A wave p = cos qx on such cells contains its aliases q + 2πm/Δ, which are equal at the centres.
The cells replace the kernel G(q) by

    Σ_m (−1)^m sin(qΔ/2) / (qΔ/2 + πm) G(|q + 2πm/Δ|),

which is G(q) to a few per mille if G falls with q. The compliance of an incompressible bonded
layer vanishes for long waves; on cells wider than the layer, aliases of short waves dominate it.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable

import numpy as np

from pellicle.arrays import Array
from pellicle.grid import Grid
from pellicle.units import readable

_WAVE = 16  # cells
_ALIASES = 200  # on either side; the sum is accurate to about 1e-5
_ALLOWED = 0.03
_FINER = 1.25
_FINEST = 100.0  # largest factor on the points each way that is recommended


def error_of_cells(compliance: Callable[[Array], Array], spacing: float) -> float:
    """Return the relative error of the compliance for a wave of 16 cells of width ``spacing`` [m].

    ``compliance`` is G(q) [m/Pa] for q > 0 [rad/m]. The error is NaN if G has no finite values.
    """
    orders = np.arange(-_ALIASES, _ALIASES + 1)
    phase = np.pi / _WAVE + np.pi * orders
    with np.errstate(all="ignore"):
        values = np.asarray(compliance(np.abs(2 * phase / spacing)), dtype=np.float64)
        weights = np.where(orders % 2, -1.0, 1.0) * np.sin(np.pi / _WAVE) / phase
        total = (weights * values).sum() / np.broadcast_to(values, phase.shape)[_ALIASES]
    return float(total) - 1.0


def warn_of_cells(compliance: Callable[[Array], Array], grid: Grid) -> None:
    """Warn if cells on a free boundary are too wide for an accuracy of a few per cent."""
    if grid.boundary != "free":
        return
    errors = [error_of_cells(compliance, spacing) for spacing in grid.spacing]
    error = max(errors, key=lambda value: abs(value) if math.isfinite(value) else 0.0)
    if not abs(error) > _ALLOWED:
        return
    factor, enough = 1.0, "more points"
    while (factor := factor * _FINER) < _FINEST:
        if all(abs(error_of_cells(compliance, d / factor)) <= _ALLOWED for d in grid.spacing):
            nx, ny = (math.ceil(n * factor) for n in grid.points)
            enough = f"about {nx} × {ny} points"
            break
    warnings.warn(
        f"grid.points: cells of {' × '.join(readable(d, 'm', 3) for d in grid.spacing)} yield to "
        f"long waves by {abs(error):.0%} {'more' if error > 0 else 'less'} than the kernel does, "
        "and forces are likely to be as wrong; an incompressible layer needs cells no wider than "
        f"it is thick: use {enough}",
        stacklevel=3,
    )


# A step between opposite edges above this multiple of steps inside means a non-periodic surface.
_STEEPER = 3.0


def warn_of_period(heights: Array, grid: Grid) -> None:
    """Warn if opposite edges of a periodic surface meet in a step.

    The rms of this step is then more than three times that between any two neighbouring lines of
    cells. ``heights`` [m] have the grid's shape.
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
                f"the surface is not periodic along {name}: its edges meet in a step of "
                f"{readable(step, 'm', 2)} (rms), where neighbouring cells differ by "
                f"{readable(inside, 'm', 2)} at most; press it on "
                'grid.boundary = "free", or make it periodic',
                stacklevel=3,
            )
