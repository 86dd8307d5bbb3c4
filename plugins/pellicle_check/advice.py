"""Advice on the grid of a run, from the same run on coarser grids."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.ndimage import binary_dilation

import pellicle as pl
from pellicle import Grid, Run, Status
from pellicle.arrays import Array, Mask
from pellicle.components import profile_of, role_of
from pellicle.errors import ConfigError
from pellicle.schema import walk

_SHARES = 1 / 4, 1 / 3, 1 / 2
"""Cells along an edge of the coarser grids, over those of the run."""
_LARGEST_SHARES = (1 / 3, 5 / 12, 1 / 2), (3 / 5, 3 / 4, 9 / 10)
"""The same where coarser ones do not resolve the indenter, however many cells these are."""
_MOST = 128
"""Largest number of cells along an edge of the coarser grids."""
_FEWEST = 8
_LEAST = 32
"""Least number of cells along an edge that is suggested."""
_MARGIN = 1.25
"""Edge of the suggested domain over the extent of the contact."""
_AREA_ERROR = 0.1
"""Relative error of the counted area up to which fewer cells are advised."""
_ROUND_OFF = 1e-9
"""Relative difference between grids up to which a quantity counts as prescribed."""
_SHORTEST_WAVE = "shortest wave"
"""Role of the field of an indenter that holds its shortest wave."""
_WIDE = 0.5
"""Share of the domain below which the contact leaves cells unused."""


class _Rule(NamedTuple):
    """How an error on a grid follows from the differences between coarser ones."""

    order: float
    """Power of the cell size with which the error falls."""
    pooled: float = 0.0
    """Factor on the root mean square of the differences of all steps, at equal cells across."""
    least: float = 0.0
    """Least error of a contact of one cell, over the value of the step."""


# The order cannot be read off three grids, whose differences vanish now and then. The share of true
# errors below the estimate, and the median ratio to them (docs/measurements/expected_errors.csv).
# Smooth contacts: force 0.97 and 3.2, depth 1.0 and 4.6, area 1.0 and 4.1; in runs of one step
# force 0.96 and 2.9, depth 1.0 and 2.3, area 0.96 and 3.1. Rough: force 1.0 and 5.2, depth 1.0 and
# 20, area 1.0 and 2.4, of one step 0.90. Punches: force 1.0 and 3.4, area 1.0 and 8.2.
_SMOOTH = _Rule(2.0, 1.5, 0.3)
_SMOOTH_DEPTH = _Rule(2.0, 1.5, 0.2)
_OTHER = _Rule(1.0)
_AREA = _Rule(1.0, 1.5, 0.7)


class Expectation(NamedTuple):
    """Force, contact and errors to expect of a load step."""

    step: int
    """Number, counted from 1."""
    force: float
    """Force on the finest of the coarser grids [N]."""
    cells: float
    """Cells across the contact, or all of its patches, on the grid of the run."""
    force_error: float
    """Expected relative error of the force, with an interaction over the largest on the path; 0
    where it is prescribed, NaN without contact or where only some grids have one."""
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

    steps: tuple[Expectation, ...]
    points: tuple[int, int]
    """Cells, on a domain of `size` if there is one, that bring the error of force and depth to the
    allowed one in every step with contact."""
    size: tuple[float, float] | None
    """Edges of a domain that fits the contact closely [m]; None where it does, or has to repeat."""
    at_edge: tuple[int, ...] = ()
    """Numbers of the steps whose contact reaches the edge of the domain of the run, where it must
    not; then all else is for the domain of `size`, which holds every step, in cells as wide."""
    cells_in_wave: float | None = None
    """Cells of the run in the shortest wave of a rough indenter; None if it names none."""


def advise(run: Run, allowed: float) -> Advice:
    """Return the expected errors of a run and a grid for an allowed error of force and depth.

    The run is solved on three coarser grids of at most 128 cells along an edge. Their differences,
    and the order with which errors of such contacts were observed to fall, give estimates that
    less than 5 of 100 true errors of force and depth exceed: order 2 for smooth contacts without
    interaction and history, 1 for others.
    """
    indenter, _ = run.indentation
    if run.grid.boundary == "free" and min(run.grid.points) == 1:
        raise ConfigError(
            f"{' × '.join(map(str, run.grid.points))} cells on a free boundary are a strip as long "
            'as grid.size, not a line contact; give "periodic", or more of grid.points each way',
            "grid.boundary",
        )
    grids = _coarser(run.grid)
    # Each of the coarser grids resolves the indenter if possible.
    for shares in _LARGEST_SHARES:
        try:
            profile_of(indenter, grids[0])
            break
        except ConfigError:
            grids = _coarser(run.grid, shares, math.inf)
    results = [_solved(run, grid) for grid in grids]
    at_edge = _at_edge(results[-1])
    if at_edge:
        size = size_for(run, at_edge)
        points = _points(run.grid, size, 1.0)
        run = _on(run, run.grid.model_copy(update={"points": points, "size": size}))
        grids = _coarser(run.grid)
        results = [_solved(run, grid) for grid in grids]
    contacts = results[-1]["contact"].values
    smooth = _is_smooth(run, grids[-1], contacts)
    steps = _expected(run, grids, results, smooth=smooth)
    with_contact = [step for step in steps if not math.isnan(step.error)]
    worst = max((step.error / allowed for step in with_contact), default=1.0)
    # Fewer cells are advised only while the area, which errs most, stays known to a tenth.
    of_areas = (min(1.0, step.area_error / _AREA_ERROR) for step in with_contact)
    factor = max(worst ** (1 / (_SMOOTH if smooth else _OTHER).order), *of_areas, 0.0)
    extent = np.max([_extent(contact, grids[-1]) for contact in contacts], axis=0)
    fitting = run.grid.size if at_edge else _fitting_size(run, extent)
    points = _points(run.grid, fitting or run.grid.size, factor)
    fields = ((value, field) for _, value, field in walk(indenter) if field)
    waves = [value for value, field in fields if role_of(field) == _SHORTEST_WAVE]
    in_wave = min(waves) / run.grid.cell_size if waves else None
    return Advice(steps, points, fitting, at_edge, in_wave)


def size_for(run: Run, at_edge: Sequence[int]) -> tuple[float, float]:
    """Return edges [m] of a domain that holds the contact of every step.

    The steps ``at_edge`` of the domain of the run are in contact or attracted on a larger one too.
    """
    scale = min(1.0, _MOST / 2 / max(run.grid.points))
    points = tuple(max(1, round(n * scale)) for n in run.grid.points)
    for factor in 2.0 ** np.arange(1, 7):
        size = factor * np.array(run.grid.size)
        grid = run.grid.model_copy(update={"points": points, "size": (size[0], size[1])})
        solved = _solved(run, grid)
        if _at_edge(solved):
            continue
        held = solved.sel(step=list(at_edge))
        acting = held["contact"].any(("x", "y")) | (held.get("zone_area", 0.0) > 0)
        if not acting.all():
            # Cells as wide as these do not see the contact.
            break
        extent = np.max([_extent(contact, grid) for contact in solved["contact"].values], axis=0)
        close = np.maximum(run.grid.size, [float(f"{_MARGIN * edge:.2g}") for edge in extent])
        # The zone of an interaction reaches beyond the contact.
        closer = grid.model_copy(update={"size": (close[0], close[1])})
        x, y = size if _at_edge(_solved(run, closer)) else close
        return float(x), float(y)
    raise ConfigError(
        "does not hold the contact of every step, nor does a larger one, up to 64 times that, on "
        "which the cells resolve it; press in less far, or give more grid.points",
        "grid.size",
    )


def _expected(
    run: Run, grids: Sequence[Grid], results: Sequence[xr.Dataset], *, smooth: bool
) -> tuple[Expectation, ...]:
    """Return force, contact and errors of each step, from results on three coarser grids.

    A difference to the finest of them, the last, is extrapolated to the cells of the run. Small
    contacts have larger errors: they take part of the differences of all steps, pooled at equal
    cells across the contact, and a least error.
    """
    force, depth, area = (
        np.array([data[name].values for data in results], dtype=float)
        for name in ("force", "depth", "contact_area")
    )
    sizes = np.array([grid.cell_size for grid in grids]) / run.grid.cell_size
    # Where the contact is lost on some grids only, forces are those of different states.
    compared = (area > 0).all(axis=0)
    cells = np.where(compared, np.sqrt(area[-1]) / run.grid.cell_size, math.nan)
    # A path with an interaction crosses 0; what is asked of it is its pull-off.
    of_forces, of_depths = np.abs(force[-1]), np.full(cells.shape, np.abs(depth[-1]).max())
    if run.interaction:
        of_forces[:] = of_forces.max()

    def errors(values: Array, scale: Array, rule: _Rule) -> list[float]:
        # A quantity that is prescribed is equal on all grids and has no error.
        exact = (np.ptp(values, axis=0) <= _ROUND_OFF * scale) | (scale == 0)
        scale = np.where(np.isnan(cells) | (scale == 0), math.nan, scale)
        falls = sizes[:-1] ** rule.order - sizes[-1] ** rule.order
        slopes = np.abs(values[:-1] - values[-1]) / scale / falls[:, None]
        differences = (slopes * cells**rule.order)[:, ~np.isnan(scale)]
        pooled = math.sqrt(np.mean(differences**2)) if differences.size else 0.0
        least = rule.least * np.abs(values[-1]) / scale
        others = np.maximum(rule.pooled * pooled, least) / cells**rule.order
        relative = np.maximum(slopes.max(axis=0), others)
        of_steps: list[float] = np.where(exact, 0.0 * scale, relative).tolist()
        return of_steps

    columns = zip(
        force[-1].tolist(),
        [max(_extent(contact, grids[-1])) for contact in results[-1]["contact"].values],
        errors(force, of_forces, _SMOOTH if smooth else _OTHER),
        errors(depth, of_depths, _SMOOTH_DEPTH if smooth else _OTHER),
        errors(area, area[-1], _AREA),
        strict=True,
    )
    return tuple(
        Expectation(number, newtons, width / run.grid.cell_size, *of_step)
        for number, (newtons, width, *of_step) in enumerate(columns, 1)
    )


def _solved(run: Run, grid: Grid) -> xr.Dataset:
    with warnings.catch_warnings():
        # Coarse grids warn of being coarse.
        warnings.simplefilter("ignore")
        return pl.run(_on(run, grid), progress=False).dataset


def _on(run: Run, grid: Grid) -> Run:
    return run.model_copy(update={"grid": grid, "outputs": ()})


def _at_edge(result: xr.Dataset) -> tuple[int, ...]:
    """Return the numbers of the steps whose contact or zone reaches an edge where it must not."""
    steps = zip(result["step"].values.tolist(), result["status_code"].values, strict=True)
    return tuple(step for step, code in steps if Status[code].at_edge)


def _extent(contact: Mask, grid: Grid) -> tuple[float, float]:
    """Return the edges of the rectangle around the contact [m]."""
    along = [np.flatnonzero(contact.any(axis=axis)) for axis in (1, 0)]
    cells = [float(np.ptp(index) + 1) if index.size else 0.0 for index in along]
    return cells[0] * grid.spacing[0], cells[1] * grid.spacing[1]


def _is_smooth(run: Run, grid: Grid, contact: Mask) -> bool:
    """Return whether all contacts are of a smooth body, away from its edges, and elastic."""
    indenter = run.indentation.indenter
    if run.interaction or run.loading.times is not None or indenter.footprint == "domain":
        return False
    beside = ~np.isfinite(profile_of(indenter, grid))
    return not (contact.any(axis=0) & binary_dilation(beside, np.ones((3, 3)))).any()


def _coarser(grid: Grid, shares: Sequence[float] = _SHARES, most: float = 2 * _MOST) -> list[Grid]:
    scale = min(1.0, most / max(grid.points))
    sizes = [[round(n * scale * share) if n > 1 else 1 for n in grid.points] for share in shares]
    if min(map(max, sizes)) < _FEWEST:
        raise ConfigError(
            f"of {grid.points} cells leave nothing to compare with; give at least "
            f"{math.ceil(_FEWEST / _SHARES[0])} along an edge",
            "grid.points",
        )
    return [grid.model_copy(update={"points": tuple(points)}) for points in sizes]


def _points(grid: Grid, size: tuple[float, float], factor: float) -> tuple[int, int]:
    """Return the cells on a domain of a size if cells become smaller by a factor."""
    cells = [
        n * factor * edge / old if n > 1 else 1.0
        for n, edge, old in zip(grid.points, size, grid.size, strict=True)
    ]
    more = max(1.0, _LEAST / min(n for n in cells if n > 1))
    nx, ny = (2 * math.ceil(n * more / 2) if n > 1 else 1 for n in cells)
    return nx, ny


def _fitting_size(run: Run, extent: Array) -> tuple[float, float] | None:
    """Return edges of a domain that fits the contact, if the present one wastes cells."""
    is_isolated = run.grid.boundary == "free" and run.indentation.indenter.footprint != "domain"
    if not is_isolated or not extent.all() or np.max(extent / run.grid.size) > _WIDE:
        return None
    edges = [float(f"{_MARGIN * edge:.2g}") for edge in extent]
    return edges[0], edges[1]
