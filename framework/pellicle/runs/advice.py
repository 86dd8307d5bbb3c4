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
_AREA_ERROR = 0.1
"""Relative error of the counted area up to which fewer cells are advised."""
_WIDE = 0.5
"""Share of the domain below which the contact leaves cells unused."""


class Expected(NamedTuple):
    """What to expect of a load step."""

    step: int
    """Number, counted from 1."""
    force: float
    """Force on the finest of the coarser grids [N]."""
    cells: float
    """Cells across the contact, or all of its patches, on the grid of the run."""
    force_error: float
    """Expected relative error of the force, 0 where it is prescribed; NaN without contact."""
    depth_error: float
    """Expected error of the depth over the largest depth; NaN without contact."""
    area_error: float
    """Expected relative error of the counted contact area; NaN without contact."""

    @property
    def error(self) -> float:
        """The larger of the errors of force and depth; NaN without contact."""
        return float(np.fmax(self.force_error, self.depth_error))


class Advice(NamedTuple):
    """The expected errors of a run, and a grid that meets an allowed one."""

    steps: tuple[Expected, ...]
    points: tuple[int, int]
    """Cells, on a domain of `size` if there is one, that bring the error of force and depth to the
    allowed one in every step with contact."""
    size: tuple[float, float] | None
    """Edges of a domain that fits the contact closely [m]; None where it does, or has to repeat."""


def advise(run: Run, allowed: float) -> Advice:
    """Return the expected errors of a run and a grid for an allowed error of force and depth.

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
    finest = results[-1]
    deepest = float(np.abs(finest["depth"]).max())
    steps = []
    for index in range(finest.sizes["step"]):
        force, depth, area = (
            np.array([float(data[name][index]) for data in results])
            for name in ("force", "depth", "contact_area")
        )
        extent = _extent(finest["contact"].values[index], grids[-1])
        errors = (
            _error(values, sizes, run.grid.cell_size) / scale if area[-1] and scale else math.nan
            for values, scale in ((force, abs(force[-1])), (depth, deepest), (area, area[-1]))
        )
        steps.append(
            Expected(index + 1, float(force[-1]), max(extent) / run.grid.cell_size, *errors)
        )
    widest = np.max([_extent(c, grids[-1]) for c in finest["contact"].values], axis=0)
    size = _fitting_size(run, widest)
    with_error = [step for step in steps if not math.isnan(step.error)]
    factor = max((step.error / allowed for step in with_error), default=1.0)
    # Fewer cells are advised only while the area, which errs most, stays known to a tenth.
    factor = max(factor, *(min(1.0, step.area_error / _AREA_ERROR) for step in with_error), 0.0)
    return Advice(tuple(steps), _points(run.grid, size or run.grid.size, factor), size)


def _points(grid: Grid, size: tuple[float, float], factor: float) -> tuple[int, int]:
    """Return the cells on a domain of a size if cells become smaller by a factor."""
    cells = [
        n * factor * edge / old if n > 1 else 1.0
        for n, edge, old in zip(grid.points, size, grid.size, strict=True)
    ]
    more = max(1.0, _LEAST / min(n for n in cells if n > 1))
    nx, ny = (2 * math.ceil(n * more / 2) if n > 1 else 1 for n in cells)
    return nx, ny


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
    """Return the expected error on cells of a size, from values on coarser ones."""
    slopes = np.abs(values[:-1] - values[-1]) / (sizes[:-1] - sizes[-1])
    return float(slopes.max() * size)


def _fitting_size(run: Run, extent: Array) -> tuple[float, float] | None:
    """Return edges of a domain that fits the contact, if the present one wastes cells."""
    is_isolated = run.grid.boundary == "free" and run.indenter.footprint != "domain"
    if not is_isolated or not extent.all() or np.max(extent / run.grid.size) > _WIDE:
        return None
    edges = [float(f"{_MARGIN * edge:.2g}") for edge in extent]
    return edges[0], edges[1]
