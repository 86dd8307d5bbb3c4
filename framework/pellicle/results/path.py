"""The variables of a run's whole path, where there is an interaction."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np

from pellicle.analysis import path_summary

from .variables import VARIABLES

if TYPE_CHECKING:
    import xarray as xr


def has_interaction(data: xr.Dataset) -> bool:
    """Whether the steps of a result, or of any run in the table of a study, attract."""
    return "zone_area" in data


def path_variables(steps: xr.Dataset) -> dict[str, float]:
    """Return the variables of kind ``path`` of the steps of a run; none without an interaction.

    They are those of `pellicle.analysis.PathSummary`, by name.
    """
    if not has_interaction(steps):
        return {}
    done = steps.isel(step=~np.isnan(steps["zone_area"].values))
    if not done.sizes["step"]:
        return {}
    names = "depth", "force", "contact_radius", "energy", "converged"
    return asdict(path_summary(*(done[name].values for name in names)))


def with_path(table: xr.Dataset) -> xr.Dataset:
    """Return the numbers of a run, or the table of a study, with the path variables of each run.

    Without an interaction the table is returned as it is.
    """
    if not has_interaction(table):
        return table
    dims = [dim for dim in table["converged"].dims if dim != "step"]
    shape = [table.sizes[dim] for dim in dims]
    values: dict[str, np.ndarray[tuple[int, ...], np.dtype[np.float64]]] = {}
    for index in np.ndindex(*shape):
        run = table.isel(dict(zip(dims, index, strict=True)))
        for name, value in path_variables(run).items():
            values.setdefault(name, np.full(shape, np.nan))[index] = value
    return table.assign(
        {name: (dims, array, VARIABLES[name].attributes) for name, array in values.items()}
    )
