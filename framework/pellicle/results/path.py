"""The path of a run: the names of its steps, and its variables where it sticks or oscillates."""

from __future__ import annotations

from dataclasses import asdict
from itertools import chain

import numpy as np

from pellicle.analysis import Oscillation, oscillations, path_summary
from pellicle.arrays import Dataset
from pellicle.units import DIGITS, readable
from pellicle.variables import VARIABLES

from .dimensions import parts
from .wording import column_of


def has_interaction(data: Dataset) -> bool:
    """Return whether the steps of a result, or of any run in the table of a study, attract."""
    return "zone_area" in data


def has_times(data: Dataset) -> bool:
    """Return whether the steps of a result, or of any run in the table of a study, have times."""
    return "time" in data


def prescribed_variable(data: Dataset) -> str:
    """Return the variable that names load steps: what is prescribed, else the depth."""
    prescribed = str(data.attrs["prescribed"])
    return prescribed if prescribed in data else "depth"


def label_of_step(data: Dataset, index: int) -> str:
    """Return what a load step prescribes: "depth 3 µm", "1 s, force 5 nN"."""
    name = prescribed_variable(data)
    label = column_of(data[name]).text(data[name].values[index].item())
    if has_times(data):
        label = f"{readable(data['time'].values[index].item(), 's', DIGITS)}, {label}"
    return label


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
    """Return the steps of a run with the variables of its path that are known, not NaN."""
    variables = path_variables(steps)
    known = {name: value for name, value in variables.items() if not np.isnan(value)}
    return steps.drop_vars(variables.keys() - known.keys(), errors="ignore").assign(
        {name: ((), value, VARIABLES[name].attributes) for name, value in known.items()}
    )
