"""Advice on the grid of a run, from the same run on coarser grids."""

from __future__ import annotations

import math
import warnings
from typing import NamedTuple

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.config.run import Run
from pellicle.errors import ConfigError
from pellicle.grid import Grid

from .runner import solve

_SHARES = 1 / 4, 1 / 3, 1 / 2
"""Cells along an edge of the coarser grids, over those of the run."""
_MOST = 128
"""Largest number of cells along an edge of the coarser grids."""
_FEWEST = 8
_LEAST = 32
"""Least number of cells along an edge that is suggested."""
_MARGIN = 1.25
"""Edge of the suggested domain over the extent of the contact."""
_WIDE = 0.5
"""Share of the domain below which the contact leaves cells unused."""


class Expected(NamedTuple):
    """What to expect of a load step."""

    step: int
    """Number, counted from 1."""
    force: float
    """Force on the finest of the coarser grids [N]."""
    cells: float
    """Cells across the contact on the grid of the run."""
    force_error: float
    """Expected relative error of the force; NaN without contact."""
    area_error: float
    """Expected relative error of the counted contact area; NaN without contact."""


class Advice(NamedTuple):
    """The expected errors of a run, and a grid that meets an allowed one."""

    steps: tuple[Expected, ...]
    points: tuple[int, int]
    """Cells that bring the error of the force to the allowed one in every step with contact."""
    size: tuple[float, float] | None
    """Edges of a domain that fits the contact closely [m]; None where it does, or has to repeat."""


def advise(run: Run, allowed: float) -> Advice:
    """Return the expected errors of a run and a grid for an allowed relative error of the force.

    The run is solved on three coarser grids of at most 128 cells along an edge. An error is taken
    as proportional to the cell size, with the largest slope between these grids: at least first
    order was observed for every kernel and indenter, so smooth contacts do better.

    Raises
    ------
    ConfigError
        The grid is too coarse to compare with coarser ones, or the indenter is tied to its grid.
    """
    grids = _coarser(run.grid)
    with warnings.catch_warnings():
        # Coarse grids warn of being coarse.
        warnings.simplefilter("ignore")
        results = [solve(_on(run, grid)).dataset for grid in grids]
    sizes = np.array([grid.cell_size for grid in grids])
    steps = []
    for index in range(results[-1].sizes["step"]):
        force, area = (
            np.array([float(data[name][index]) for data in results])
            for name in ("force", "contact_area")
        )
        extent = _extent(results[-1]["contact"].values[index], grids[-1])
        steps.append(
            Expected(
                index + 1,
                float(force[-1]),
                max(extent) / run.grid.cell_size,
                _error(force, sizes, run.grid.cell_size),
                _error(area, sizes, run.grid.cell_size),
            )
        )
    known = [step.force_error for step in steps if not math.isnan(step.force_error)]
    factor = max(known) / allowed if known else 1.0
    nx, ny = (max(_LEAST, 2 * math.ceil(n * factor / 2)) if n > 1 else 1 for n in run.grid.points)
    widest = np.max([_extent(c, grids[-1]) for c in results[-1]["contact"].values], axis=0)
    return Advice(tuple(steps), (nx, ny), _fitting_size(run, widest))


def _coarser(grid: Grid) -> list[Grid]:
    scale = min(1.0, 2 * _MOST / max(grid.points))
    grids = []
    for share in _SHARES:
        points = tuple(round(n * scale * share) if n > 1 else 1 for n in grid.points)
        if max(points) < _FEWEST:
            raise ConfigError(
                f"of {grid.points} cells leave nothing to compare with; give at least "
                f"{math.ceil(_FEWEST / _SHARES[0])} along an edge",
                "grid.points",
            )
        grids.append(grid.model_copy(update={"points": points}))
    return grids


def _on(run: Run, grid: Grid) -> Run:
    return run.model_copy(update={"grid": grid, "outputs": ()})


def _extent(contact: Mask, grid: Grid) -> tuple[float, float]:
    """Return the edges of the rectangle around the contact [m]."""
    along = [np.flatnonzero(contact.any(axis=axis)) for axis in (1, 0)]
    cells = [float(np.ptp(index) + 1) if index.size else 0.0 for index in along]
    return cells[0] * grid.spacing[0], cells[1] * grid.spacing[1]


def _error(values: Array, sizes: Array, size: float) -> float:
    """Return the expected relative error on cells of a size, from values on coarser ones."""
    if not values[-1]:
        return math.nan
    slopes = np.abs(values[:-1] - values[-1]) / (sizes[:-1] - sizes[-1])
    return float(slopes.max() * size / abs(values[-1]))


def _fitting_size(run: Run, extent: Array) -> tuple[float, float] | None:
    """Return edges of a domain that fits the contact, if the present one wastes cells."""
    is_isolated = run.grid.boundary == "free" and run.indenter.footprint != "domain"
    if not is_isolated or not extent.all() or np.max(extent / run.grid.size) > _WIDE:
        return None
    edges = [float(f"{_MARGIN * edge:.2g}") for edge in extent]
    return edges[0], edges[1]
