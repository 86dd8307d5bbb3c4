"""What the explorer shows of a run: numbers of each load step, and cuts through the contact."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.arrays import Array
from pellicle.config.run import Run
from pellicle.results.result import Result
from pellicle.runs.runner import solve

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Frame:
    """The result of a run, and a cut through the contact at its largest force, SI."""

    result: Result
    step: int
    """Index of that load step."""
    x: Array
    """Positions along x [m], shape (nx,)."""
    pressure: Array
    """Pressure at the largest force along x through the deepest point [Pa], shape (nx,)."""
    surface: Array
    """Height of the surface there, negative below the undeformed one [m], shape (nx,)."""
    indenter: Array
    """Height of the indenter there [m], shape (nx,); NaN beside it."""
    spacing: tuple[float, float]
    """Sides of a cell [m]."""
    warnings: tuple[str, ...]
    """What the run warns of."""

    @property
    def steps(self) -> xr.Dataset:
        """The dataset of the run."""
        return self.result.dataset


def solved(document: Mapping[str, Any]) -> Frame:
    """Solve the run that a document describes.

    Raises
    ------
    ConfigError, PluginError
        The document is not a run, or it cannot be executed.
    """
    run = Run.from_mapping(document)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = solve(run)
    step = int(np.argmax(result.dataset["force"].values))
    deepest = result.dataset.isel(step=step)
    row = int(np.argmax(np.max(deepest["displacement"].values, axis=0)))
    cut = deepest.isel(y=row)
    surface, gap = -cut["displacement"].values, np.maximum(cut["gap"].values, 0.0)
    return Frame(
        result,
        step,
        cut["x"].values,
        cut["pressure"].values,
        surface,
        np.where(np.isfinite(gap), surface + gap, np.nan),
        run.grid.spacing,
        tuple(dict.fromkeys(str(entry.message) for entry in caught)),
    )
