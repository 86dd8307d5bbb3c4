"""Plans, runs and keeps the study that the force curve of any indenter on any solid needs."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import platformdirs

from pellicle.arrays import Array
from pellicle.components import Executor, Indenter
from pellicle.config.study import Study
from pellicle.errors import ConfigError, ConvergenceError
from pellicle.plugins import registry
from pellicle.studies.runner import carry_out, is_table, read
from pellicle.studies.summary import failures

from .extent import half_widths
from .interpolated import SCALE, SimulatedCurve, stretched
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
    cache: str | Path | None = None,
    executor: str | Mapping[str, Any] | Executor = "serial",
    grid_points: int = GRID_POINTS,
    progress: bool = False,
) -> SimulatedCurve:
    """Return the force curve of an indenter, from a study that is run unless it is there already.

    The study is that of a reduced modulus of 1 Pa and of lengths over one of the problem's own, so
    that it serves every indenter and solid of these proportions.

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
    planned = plan(indenter, solid, deepest, grid_points)
    if isinstance(executor, str):
        executor = {"type": executor}
    folder = Path(cache) if cache else platformdirs.user_cache_path("pellicle")
    table = _table(planned.study(executor), folder / "force-curves", progress)
    forces = table["force"].values.reshape(2, planned.depths.size, _RATIOS.size)
    if not (forces > 0).all():
        raise ConvergenceError("some contacts of the study carry no force; give more grid points")
    made = partial(
        SimulatedCurve,
        indenter,
        solid.given,
        planned.depths,
        _RATIOS,
        width=planned.width,
        unit=planned.unit,
    )
    return made(np.log(forces[0]), coarse=made(np.log(forces[1])))


@dataclass(frozen=True)
class Plan:
    """The contacts that a force curve needs, in lengths over `unit`."""

    unit: float
    """[m]"""
    kernel: Mapping[str, Any]
    tension: str
    """Dotted path of the tension in the kernel."""
    indenter: Mapping[str, Any]
    depths: Array
    boxes: Array
    """Edges of the grid at each depth, of shape (m, 2)."""
    width: tuple[float, float]
    """Slope and value at δ = 1 of log w over log δ."""
    grid_points: int

    def study(self, executor: Mapping[str, Any] | Executor) -> Study:
        """Return the study: each contact on a grid of its own, and on one of half the cells."""
        slope, intercept = self.width
        widths = np.exp(intercept + slope * np.log(self.depths))
        count = _RATIOS.size
        return Study.from_mapping(
            {
                "title": f"force curve of {self.indenter['type']} on {self.kernel['type']}",
                "grid": {"points": self.grid_points, "size": 1.0},
                "kernel": self.kernel,
                "indenter": self.indenter,
                "loading": {"depth": 1.0},
                "outputs": [],
                "study": {
                    "vary": {"grid.points": [self.grid_points, self.grid_points // 2]},
                    "zip": [
                        {
                            "loading.depth": np.repeat(self.depths, count).tolist(),
                            f"kernel.{self.tension}": np.outer(widths, _RATIOS / 2)
                            .ravel()
                            .tolist(),
                            "grid.size": np.repeat(self.boxes, count, axis=0).tolist(),
                        }
                    ],
                    "executor": executor,
                },
            }
        )


def plan(indenter: Indenter, solid: Solid, deepest: float, grid_points: int = GRID_POINTS) -> Plan:
    """Return which contacts the force curve of an indenter needs down to a depth [m].

    Raises
    ------
    ConfigError
        As for `simulate`.
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
    given = [*lengths(indenter), *lengths(solid.kernel), deepest]
    unit = (
        next(value for value in given if value > 0)
        if scales(indenter) and scales(solid.kernel)
        else 1.0
    )
    try:
        kernel = scaled(solid.kernel, unit, (solid.modulus, solid.tension))
    except ConfigError as error:
        raise error.within("kernel") from None
    shape = scaled(indenter, unit)
    # Rounded up, so that curves of about the same depth share a study.
    top = int(np.ceil(np.log2(deepest / unit) - 1e-9))
    depths: Array = 2.0 ** np.arange(top - _OCTAVES, top + 1, dtype=np.float64)
    made = registry().make(Indenter, shape)
    halves = np.array([half_widths(made, depth) for depth in depths])
    slope, intercept = np.polyfit(np.log(depths), np.log(halves.prod(axis=1)) / 2, 1)
    margin = _MARGIN_OF_LAYERS if lengths(solid.kernel) else _MARGIN
    return Plan(
        unit,
        kernel,
        solid.tension,
        shape,
        depths,
        2 * margin * halves,
        (float(slope), float(intercept)),
        grid_points,
    )


def _table(study: Study, cache: Path, progress: bool) -> xr.Dataset:
    """Return the table of a study, run if need be; of its runs nothing else is kept."""
    runs = [point.run.identity for point in study.points]
    folder = cache / hashlib.sha256("".join(runs).encode()).hexdigest()[:16]
    if is_table(folder):
        found, _ = read(folder)
        if not failures(found):
            return found
    made = carry_out(study, folder, progress=progress).table
    if said := failures(made):
        raise ConvergenceError(
            f"the force curve needs the study in {folder}: {said}; another number of grid points "
            "may help"
        )
    shutil.rmtree(folder / "runs")
    return made
