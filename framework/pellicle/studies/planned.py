"""A study before anything is solved, to which the settings of its outputs have to fit."""

from __future__ import annotations

import numpy as np
import xarray as xr

from pellicle.checks import errors_attributed_to
from pellicle.components import Runs
from pellicle.config.provenance import facts_of
from pellicle.config.study import Study
from pellicle.errors import ConfigError
from pellicle.results.derived import CELLS, derive
from pellicle.results.runs import StoredRuns
from pellicle.variables import FIELDS, VARIABLES, WALL_PRESSURE

from .table import StudyTable


def check_outputs(study: Study) -> None:
    """Refuse settings of outputs that do not fit the axes, runs and numbers of a study."""
    runs = _planned(study)
    for number, output in enumerate(study.points[0].run.outputs or ()):
        if output.scope == "run":
            continue
        try:
            with errors_attributed_to(output), np.errstate(all="ignore"):
                output.check(runs)
        except ConfigError as error:
            raise error.within(f"outputs.{number}") from None


def _planned(study: Study) -> Runs:
    """Return the runs of a study with NaN for all numbers, and their last steps on four cells."""
    table = StudyTable(study).dataset()
    steps = table["status"]
    variables = {v.name: v for point in study.points for v in point.run.variables}
    for name, variable in variables.items():
        of_run = variable.kind in ("path", "oscillation")
        like = steps.isel(step=-1, drop=True) if of_run else steps
        empty = np.full(like.shape, variable.type != "truth" and np.nan)
        table[name] = like.dims, empty, variable.attributes
    points = {point.run.identity[:16]: point for point in study.points}

    def last_step(name: str) -> xr.Dataset:
        position, run = points[name].position, points[name].run
        where = *position, [len(run.loading.values) - 1]
        row = table.isel(dict(zip(steps.dims, where, strict=True))).reset_coords(drop=True)
        for field in (*FIELDS, *[WALL_PRESSURE] * bool(run.interaction)):
            cells = np.zeros((1, 2, 2), bool if VARIABLES[field].type == "truth" else float)
            row[field] = ("step", *CELLS), cells, VARIABLES[field].attributes
        sides = [edge / 4 * np.array([-1, 1]) for edge in run.grid.size]
        row = row.assign_coords(dict(zip(CELLS, sides, strict=True)))
        return row.assign_attrs(configuration=run.to_json(), **facts_of([run]))

    return StoredRuns(derive(table, study.derived, {}), last_step, study.to_json(portable=True))
