"""Describe the surface under a known load, and judge whether theory and cells hold it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from pellicle.analysis import ridge, steepest
from pellicle.components import Load
from pellicle.config.run import Run
from pellicle.contact.caveats import Caveat, Status
from pellicle.contact.load_step import Value
from pellicle.surface import along_axes

from . import SMALL_SLOPE, AnyStep, Surroundings

# Rounding error of a sum of tractions that balance, over that of their sizes.
_ROUNDING: Final = 1e-12
# Fall of G(q) q over a decade of short waves from which a line force has a finite height.
_FALLS: Final = 0.9
# Cells across the finest part of a load with which the heights beside it are right to 5 %.
_RESOLVED_ACROSS: Final = 4
# Share of the height of a ridge that waves shorter than the cells may make up.
_LACKING: Final = 0.02


def surface(run: Run, step: AnyStep, around: Surroundings) -> AnyStep:
    """Add the numbers of the surface under a load, and what is beyond theory or cells."""
    displacement = step.equilibrium.displacement
    if not np.isfinite(displacement).all():
        return step.with_measures({}, [Caveat(Status.NOT_FINITE)])
    slope = steepest(displacement, np.ones(displacement.shape, dtype=bool), run.grid)
    measures: dict[str, Value] = dict(ridge(displacement, run.grid)._asdict())
    pressure = step.equilibrium.pressure
    if abs(float(pressure.sum())) <= _ROUNDING * float(np.abs(pressure).sum()):
        measures |= {"force": 0.0, "mean_pressure": 0.0}
    assert run.load is not None
    if path := run.load.varying_field:
        measures[path.variable.name] = path.values[len(around.path)]
    load = run.load.at(len(around.path))
    return step.with_measures(measures | {"surface_slope": slope}, _limits(run, load, slope))


def _limits(run: Run, load: Load, slope: float) -> Iterator[Caveat]:
    """Yield what is beyond the theory, or depends on the cells.

    Under a line force the surface has a finite height if G(q) falls faster than 1/q.
    """
    if slope > SMALL_SLOPE:
        yield Caveat(Status.STEEP_SURFACE, {"slope": slope, "most": SMALL_SLOPE})
    q = 1e3 * np.pi / min(run.grid.spacing) * np.array([1.0, 10.0])
    a, b = along_axes(run.kernel.symbol, q) * q
    if load.has_line_without_width and b > _FALLS * a:
        yield Caveat(Status.LINE_OF_CELLS, {"width": run.grid.cell_size})
    elif load.has_line_without_width and (share := _lacking(run)) > _LACKING:
        yield Caveat(Status.COARSE_LINE, {"width": min(run.grid.spacing), "share": share})
    across = load.cells_across(*run.grid.spacing)
    if across < _RESOLVED_ACROSS:
        yield Caveat(Status.COARSE_LOAD, {"across": across, "least": _RESOLVED_ACROSS})


def _lacking(run: Run) -> float:
    """Return the share of a ridge's height, ∫G dq, that a line as wide as a cell leaves out.

    Waves longer than 2π times the domain count as none: rings on skins lack 0.9 of it or more.
    """
    cell = min(run.grid.spacing)
    q = np.geomspace(1 / max(run.grid.size), 1e4 * np.pi / cell, 4096)
    heights = along_axes(run.kernel.symbol, q) * q
    return float((heights * (1 - np.sinc(0.5 * cell * q / np.pi))).sum() / heights.sum())
