"""Small runs that the rules solve."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pellicle.config.run import Run
from pellicle.runs.runner import solve

from .rules import require

if TYPE_CHECKING:
    import xarray as xr


def solved(configuration: dict[str, Any]) -> xr.Dataset:
    """Return the dataset of a run, every step of which must converge."""
    run = Run(**configuration)
    result = solve(run)
    for step, message in result.failures():
        what = f"{run.grid.boundary} boundary, {run.loading.prescribed} prescribed"
        require(False, f"step {step} of a run ({what}) did not converge: {message}")
    return result.dataset
