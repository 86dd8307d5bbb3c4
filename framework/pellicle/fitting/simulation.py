"""Plans, runs and keeps the study that the force curve of any indenter on any solid needs."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import platformdirs

from pellicle.components import Executor, Indenter
from pellicle.errors import ConfigError, ConvergenceError
from pellicle.operators import Array
from pellicle.study import as_study, carry_out, failures, is_table, read

from .extent import half_widths
from .simulated import SCALE, SimulatedCurve, stretched
from .solid import Solid, lengths, scaled, scales

if TYPE_CHECKING:
    import xarray as xr

GRID_POINTS = 64
_FEWEST = 16
_OCTAVES = 6
"""Depths go down from the deepest by factors of 2."""
_RATIOS: Array = SCALE * np.expm1(np.linspace(0, stretched(np.array([30.0]))[0], 11))
"""Nodes s/w; the spline between them errs by 1e-4."""
_MARGIN = 1.08
_MARGIN_OF_LAYERS = 1.9
"""A thin incompressible layer swells beside the contact, which is then up to √3 times as wide."""


def simulate(
    indenter: Indenter,
    solid: Solid,
    deepest: float,
    *,
    cache: Path | None = None,
    executor: str | Mapping[str, Any] | Executor = "serial",
    grid_points: int = GRID_POINTS,
    progress: bool = False,
) -> SimulatedCurve:
    """Return the force curve of an indenter, from a study that is run unless it is there already.

    The study is that of a reduced modulus of 1 Pa and of lengths over one of the problem's own, so
    that it serves every indenter and solid of these proportions.  Each contact is solved on a grid
    of its own size, and once more with half as many cells each way.

    Parameters
    ----------
    indenter, solid
        What is pressed in, and into what.
    deepest
        Depth [m] up to which the curve is needed.
    cache
        Folder that keeps the studies; the user's cache folder if None.
    executor
        What carries out the runs.
    grid_points
        Cells of each grid along x and y.
    progress
        Show how far the study is.

    Raises
    ------
    ConfigError
        The indenter has no size of its own, or the solid's fields count against the modulus.
    ConvergenceError
        A run of the study failed; its table says which and why.
    StorageError
        The folder cannot be used, or another process is at it.
    """
    if indenter.footprint != "unbounded":
        raise ConfigError(
            "ends where the grid does, so it has no force curve of its own; give one that has a "
            "shape",
            "indenter",
        )
    if grid_points < _FEWEST or grid_points % 2:
        raise ConfigError(
            f"{grid_points} is not allowed; give an even number ≥ {_FEWEST}", "grid_points"
        )
    if isinstance(executor, str):
        executor = {"type": executor}
    fit_lengths = lengths(indenter) or lengths(solid.kernel) or [deepest]
    unit = fit_lengths[0] if scales(indenter) and scales(solid.kernel) else 1.0
    free = (solid.modulus, solid.tension)
    try:
        kernel = scaled(solid.kernel, unit, free)
    except ConfigError as error:
        raise error.within("kernel") from None
    shape = scaled(indenter, unit)
    top = int(np.ceil(np.log2(deepest / unit) - 1e-9))
    depths: Array = 2.0 ** np.arange(top - _OCTAVES, top + 1, dtype=np.float64)
    boxes = np.array([half_widths(type(indenter)(**shape), depth) for depth in depths])
    slope, intercept = np.polyfit(np.log(depths), np.log(boxes.prod(axis=1)) / 2, 1)
    widths = np.exp(intercept + slope * np.log(depths))
    margin = _MARGIN_OF_LAYERS if lengths(solid.kernel) else _MARGIN
    tensions = np.outer(widths, _RATIOS) / 2
    data = {
        "title": f"force curve of {kernel['type']} under {shape['type']}",
        "grid": {"points": grid_points, "size": 1.0},
        "kernel": kernel,
        "indenter": shape,
        "loading": {"depth": 1.0},
        "outputs": [],
        "study": {
            "vary": {"grid.points": [grid_points, grid_points // 2]},
            "zip": [
                {
                    "loading.depth": np.repeat(depths, _RATIOS.size).tolist(),
                    f"kernel.{solid.tension}": tensions.ravel().tolist(),
                    "grid.size": np.repeat(2 * margin * boxes, _RATIOS.size, axis=0).tolist(),
                }
            ],
            "executor": executor,
        },
    }
    table = _table(data, cache or platformdirs.user_cache_path("pellicle"), progress)
    forces = table["force"].values.reshape(2, depths.size, _RATIOS.size)
    if not (forces > 0).all():
        raise ConvergenceError("some contacts of the study carry no force; give more grid points")
    made = partial(
        SimulatedCurve,
        indenter,
        solid.kernel,
        depths,
        _RATIOS,
        width=(float(slope), float(intercept)),
        unit=unit,
    )
    return made(np.log(forces[0]), coarse=made(np.log(forces[1])))


def _table(data: dict[str, Any], cache: Path, progress: bool) -> xr.Dataset:
    """Return the table of a study, run if need be; of its runs nothing else is kept."""
    study = as_study(data)
    runs = [point.run.identity for point in study.points]
    folder = cache / "force-curves" / hashlib.sha256("".join(runs).encode()).hexdigest()[:16]
    if is_table(folder):
        found, _ = read(folder)
        if not failures(found):
            return found
    made = carry_out(study, folder, progress=progress).table
    if said := failures(made):
        raise ConvergenceError(f"the force curve needs the study in {folder}: {said}")
    shutil.rmtree(folder / "runs")
    return made
