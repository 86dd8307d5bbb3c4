"""Plan, run and cache the study behind the force curve of any indenter on any solid."""

from __future__ import annotations

import hashlib
import shutil
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import platformdirs

from pellicle import Grid, Study, results, run_study
from pellicle.arrays import Array
from pellicle.components import Executor, Indenter
from pellicle.errors import ConfigError, ConvergenceError, ConvergenceWarning
from pellicle.units import readable

from .interpolated import SCALE, SimulatedCurve, stretched
from .solid import UnitKernel, quantities_of

GRID_POINTS = 64
_OCTAVES = 6
"""Number of factors of 2 between the deepest and the shallowest node."""
_RATIOS: Array = SCALE * np.expm1(np.linspace(0, stretched(np.array([30.0]))[0], 11))
"""Nodes s/w; the spline between them has a relative error of about 1e-4."""
_MARGIN = 1.08
_MARGIN_OF_LAYERS = 1.9
"""Edge of the grid over the width of the indenter: an incompressible thin layer bulges beside the
contact, which is then up to √3 times as wide."""
_CELLS = 129
"""Samples of the indenter along each axis when its width is measured."""
_CLOSE = 0.95
"""Least width of the indenter over that of the sampled domain."""
_WIDEST = 1e9


def simulated_curve(
    indenter: Indenter,
    solid: UnitKernel,
    deepest: float,
    *,
    cache: str | Path | None = None,
    executor: str | Executor = "serial",
    grid_points: int = GRID_POINTS,
    progress: bool = False,
) -> SimulatedCurve:
    """Return the force curve of an indenter on a solid down to a depth [m], from a study.

    The study, of a reduced modulus of 1 Pa, is run here unless the folder ``cache`` has it, the
    user's own if None; ``grid_points`` are the cells of each grid along x and y.

    Raises
    ------
    ConfigError
        The indenter ends where the grid does, or its contact nowhere.
    ConvergenceError, StorageError
        A run fails, or the folder cannot be used.
    """
    depths, width, table = plan(indenter, solid, deepest, grid_points)
    table["study"]["executor"] = {"type": executor} if isinstance(executor, str) else executor
    study = Study.from_mapping(table)
    runs = "".join(point.run.identity for point in study.points)
    folder = Path(cache) if cache else platformdirs.user_cache_path("pellicle")
    folder = folder / "force-curves" / hashlib.sha256(runs.encode()).hexdigest()[:16]
    # Once all runs have converged they are deleted, so a table without them is whole.
    if (folder / "study.h5").exists() and not (folder / "runs").exists():
        results_table = results.table(folder / "study.h5")
    else:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", ConvergenceWarning)
                results_table = run_study(study, folder, progress=progress)
        except ConvergenceWarning as warning:
            raise ConvergenceError(
                f"the force curve needs the study in {folder}: {warning}; another number of "
                "grid points may help"
            ) from None
        shutil.rmtree(folder / "runs")
    # Each contact on a grid of its own, and on one of half the cells.
    forces = results_table["force"].values.reshape(2, depths.size, _RATIOS.size)
    if not (forces > 0).all():
        raise ConvergenceError("some contacts of the study carry no force; give more grid points")
    accuracy = float(np.max(np.abs(forces[1] / forces[0] - 1)))
    return SimulatedCurve(depths, _RATIOS, width, np.log(forces[0]), accuracy, solid.is_half_space)


def plan(
    indenter: Indenter, solid: UnitKernel, deepest: float, grid_points: int = GRID_POINTS
) -> tuple[Array, tuple[float, float], dict[str, Any]]:
    """Return depths of nodes down to one [m], the width of contacts there, and their study."""
    if indenter.footprint != "unbounded":
        raise ConfigError(
            "ends where the grid does, so it has no force curve of its own; give one whose shape "
            "does not depend on the grid",
            "indenter",
        )
    # Rounded up, so that curves of about the same depth share a study.
    top = int(np.ceil(np.log2(deepest) - 1e-9))
    depths: Array = 2.0 ** np.arange(top - _OCTAVES, top + 1, dtype=np.float64)
    halves = np.array([half_widths(indenter, depth) for depth in depths])
    slope, intercept = np.polyfit(np.log(depths), np.log(halves.prod(axis=1)) / 2, 1)
    widths = np.exp(intercept + slope * np.log(depths))
    is_layered = any(quantity.unit == "m" for _, quantity, _ in quantities_of(solid.kernel))
    boxes = 2 * (_MARGIN_OF_LAYERS if is_layered else _MARGIN) * halves
    contacts = {
        "loading.depth": np.repeat(depths, _RATIOS.size).tolist(),
        f"kernel.{solid.tension}": np.outer(widths, _RATIOS / 2).ravel().tolist(),
        "grid.size": np.repeat(boxes, _RATIOS.size, axis=0).tolist(),
    }
    study: dict[str, Any] = {
        "title": f"force curve of {indenter.type_name} on {solid.kernel.type_name}",
        "grid": {"points": grid_points, "size": 1.0},
        "kernel": solid.kernel.model_dump(exclude_none=True),
        "indenter": indenter.model_dump(exclude_none=True),
        "loading": {"depth": 1.0},
        "outputs": [],
        "study": {"vary": {"grid.points": [grid_points, grid_points // 2]}, "zip": [contacts]},
    }
    return depths, (float(slope), float(intercept)), study


def half_widths(indenter: Indenter, depth: float) -> tuple[float, float]:
    """Return half the width [m] along x and y of the indenter below the undeformed surface.

    On any kernel whose Green's function is positive the contact lies inside that part of the
    indenter.
    """
    half = np.array([depth, depth])
    while True:
        axes = Grid(points=_CELLS, size=tuple((2 * half).tolist())).coordinates()
        below = np.asarray(indenter.profile(*axes)) >= -depth
        reach = np.array([np.max(np.where(below, np.abs(x), 0.0)) for x in axes])
        outside = reach >= [np.max(np.abs(x)) for x in axes]
        fitted = reach + half / _CELLS
        if not outside.any() and (fitted >= _CLOSE * half).all():
            return float(fitted[0]), float(fitted[1])
        # At least one cell, so that the domain cannot shrink past the shape in one step.
        smaller = half if outside.any() else np.maximum(1.02 * fitted, 2 * half / _CELLS)
        half = np.where(outside, 2 * half, smaller)
        if half.max() > _WIDEST * depth:
            raise ConfigError(
                f"is less than {readable(depth, 'm')} high out to {readable(half.max(), 'm', 2)}; "
                "give one whose contact ends",
                "indenter",
            )
