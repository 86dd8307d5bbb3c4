"""The path of a run: the names of its steps, and its variables where it sticks or oscillates."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from itertools import chain
from math import isfinite, nan, sqrt

import numpy as np

from pellicle.analysis import Oscillation, oscillations, path_summary
from pellicle.arrays import DataArray, Dataset
from pellicle.contact.caveats import Caveat, Status, from_text, rank_caveats, to_text
from pellicle.grid import Grid
from pellicle.units import DIGITS, readable
from pellicle.variables import CAVEATS, VARIABLES

from .derived import configuration_of
from .dimensions import parts
from .wording import column_of

FEW_CELLS = 12
"""Contact radius in cells below which force and radius may be off by more than 2 %."""


def has_interaction(data: Dataset) -> bool:
    """Return whether the steps of a result, or of any run in the table of a study, attract."""
    return "zone_area" in data


def has_load(data: Dataset) -> bool:
    """Return whether a result, or each run in the table of a study, has a load and no indenter."""
    return "ridge_height" in data and "depth" not in data


def contact_of(step: Dataset) -> DataArray:
    """Return which cells of a load step are in contact: none under a load."""
    return step["contact"] if "contact" in step else step["pressure"] != step["pressure"]


def has_times(data: Dataset) -> bool:
    """Return whether the steps of a result, or of any run in the table of a study, have times."""
    return "time" in data


def prescribed_variable(data: Dataset) -> str:
    """Return the variable that names load steps: what is prescribed, else depth or force."""
    prescribed = str(data.attrs["prescribed"])
    return prescribed if prescribed in data else "force" if has_load(data) else "depth"


def label_of_step(data: Dataset, index: int) -> str:
    """Return what a load step prescribes: "depth 3 µm", "1 s, force 5 nN", of a load "step 1"."""
    name = prescribed_variable(data)
    is_bare = has_load(data) and name == "force"
    label = column_of(data[name]).text(data[name].values[index].item())
    if has_times(data):
        time = readable(data["time"].values[index].item(), "s", DIGITS)
        return time if is_bare else f"{time}, {label}"
    return f"step {data['step'].values[index].item()}" if is_bare else label


def has_path(data: Dataset) -> bool:
    """Return whether a result, or any run of a study, has variables of its whole path."""
    return has_interaction(data) or "cycle" in data


def oscillations_of(steps: Dataset) -> list[Oscillation]:
    """Return the response of each oscillation on the path of a run."""
    if "cycle" not in steps:
        return []
    done = steps.isel(step=np.isfinite(steps["time"].values))
    names = "time", "cycle", "depth", "force", "converged"
    return oscillations(*(done[name].values for name in names))


def path_variables(steps: Dataset) -> dict[str, float]:
    """Return the variables of kinds ``path`` and ``oscillation`` of the steps of a run.

    They are those of `pellicle.analysis.PathSummary` where there is an interaction, and of the last
    `pellicle.analysis.Oscillation` where there is one, by name.
    """
    variables: dict[str, float] = {}
    if has_interaction(steps):
        # Without the fields, which would be copied.
        numbers = steps.drop_dims(["x", "y"], errors="ignore")
        done = numbers.isel(step=~np.isnan(steps["zone_area"].values))
        if done.sizes["step"]:
            names = "depth", "force", "contact_radius", "energy", "converged", "force_error"
            columns = {name: done[name].values for name in names if name in done}
            variables |= asdict(path_summary(**columns))
    for oscillation in oscillations_of(steps)[-1:]:
        variables |= asdict(oscillation)
    return variables


def with_path(table: Dataset) -> Dataset:
    """Return the numbers of a run, or the table of a study, with the path variables of each run.

    Without an interaction or an oscillation the table is returned as it is.
    """
    if not has_path(table):
        return table
    dims = [dim for dim in table["converged"].dims if dim != "step"]
    shape = [table.sizes[dim] for dim in dims]
    runs = [path_variables(run) for run in parts(table, dims)]
    columns = {
        name: np.array([run.get(name, np.nan) for run in runs], dtype=float).reshape(shape)
        for name in dict.fromkeys(chain.from_iterable(runs))
    }
    return table.assign(
        {name: (dims, column, VARIABLES[name].attributes) for name, column in columns.items()}
    )


def with_events(steps: Dataset) -> Dataset:
    """Return the steps of a run with the known variables of its path, and the caveat of these."""
    variables = path_variables(steps)
    known = {name: value for name, value in variables.items() if not np.isnan(value)}
    steps = steps.drop_vars(variables.keys() - known.keys(), errors="ignore").assign(
        {name: ((), value, VARIABLES[name].attributes) for name, value in known.items()}
    )
    for index, caveat in _few_at_pull_off(steps, variables):
        # Texts that were read from a file have a fixed length.
        caveats = steps[CAVEATS].astype(object)
        others = (c for c in from_text(caveats.values[index]) if c.status is not caveat.status)
        caveats.values[index] = to_text(rank_caveats([*others, caveat]))
        steps = steps.assign({CAVEATS: caveats})
    return steps


def _few_at_pull_off(steps: Dataset, path: Mapping[str, float]) -> Iterator[tuple[int, Caveat]]:
    """Yield index and caveat of the step at pull-off if its contact has few cells.

    No error of the force is known of an interaction with a range that is not that of the cells.
    """
    if "force_error" not in steps or not path.get("pull_off", nan) < 0:
        return
    grid = Grid(**configuration_of(steps)["grid"])
    cells = path["pull_off_radius"] / sqrt(grid.cell_area)
    if 0 < cells < FEW_CELLS and min(grid.shape) > 1:
        error = path["pull_off_accuracy"] / -path["pull_off"]
        off = "known error" if isfinite(error) else "unknown error"
        caveat = Caveat(Status.FEW_AT_PULL_OFF, {"cells": cells, "error": error, "off": off})
        yield int(path["pull_off_step"]) - 1, caveat
