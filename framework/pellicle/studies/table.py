"""The table of a study: the numbers of its runs over the varied parameters, first without any."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from pellicle.checks import errors_attributed_to
from pellicle.components import Column, Runs, Table
from pellicle.config.coordinates import units_of
from pellicle.config.provenance import facts_of, now_with
from pellicle.config.study import Study
from pellicle.contact.caveats import Caveat, Status
from pellicle.errors import problems_within
from pellicle.files import for_document
from pellicle.results import storage
from pellicle.results.derived import CELLS, DERIVED, FIRST_RUN, VARYING, derive
from pellicle.results.dimensions import with_python_names
from pellicle.results.path import with_path
from pellicle.results.runs import StoredRuns
from pellicle.show.numbers import write_csv
from pellicle.variables import CAVEATS, FIELDS, FIELDS_OF_LOAD, VARIABLES, WALL_PRESSURE

_SHARE_OF_WRITING = 0.05
_TEXTS = "status_code", "status", CAVEATS


class StudyTable:
    """Collects the numbers of the runs of a study as they finish."""

    def __init__(self, study: Study) -> None:
        self._study = study
        self._attributes = {
            "title": for_document(study.points[0].run.title),
            "configuration": study.to_json(),
            FIRST_RUN: study.points[0].run.to_json(portable=True),
            DERIVED: json.dumps(study.derived),
            VARYING: json.dumps(sorted(study.varying)),
            "axes": json.dumps({name: list(axes) for name, axes in study.dimensions.items()}),
            **facts_of([point.run for point in study.points]),
            **now_with(point.run for point in study.points),
        }
        steps = {point.position: point.run.steps for point in study.points}
        shape = *study.shape, max(steps.values())
        self._values: dict[str, np.ndarray[Any, np.dtype[Any]]] = {
            name: np.full(shape, "", dtype=object) for name in _TEXTS
        }
        self._runs = np.full(study.shape, "", dtype=object)
        for point in study.points:
            count = steps[point.position]
            self._values["status"][point.position][:count] = Status.NOT_RUN.value
            self._values["status_code"][point.position][:count] = Status.NOT_RUN.name
            self._runs[point.position] = point.run.identity[:16]
        self._descriptions: dict[str, dict[str, str]] = {}
        self._next_write = 0.0
        self.files: tuple[Path, ...] = ()
        """The files of the table that `write` wrote."""

    def put(self, index: tuple[int, ...], scalars: xr.Dataset) -> None:
        """Store the steps of a run."""
        count = scalars.sizes["step"]
        for name, variable in scalars.data_vars.items():
            self._descriptions.setdefault(str(name), dict(variable.attrs))
            missing = False if variable.dtype == bool else np.nan
            empty = np.full(self._values["status"].shape, missing)
            self._values.setdefault(str(name), empty)[index][:count] = variable.values

    def fail(self, index: tuple[int, ...], reason: str) -> str:
        """Record why the remaining steps of a run are missing, and return it as a sentence."""
        codes = self._values["status_code"][index]
        missing = codes == Status.NOT_RUN.name
        codes[missing] = Status.FAILED.name
        sentence = Caveat(Status.FAILED, {"reason": reason}).sentence
        self._values["status"][index][missing] = sentence
        return sentence

    def dataset(self) -> xr.Dataset:
        """Return the table, with NaN for missing numbers."""
        dimensions = *self._study.dimensions, "step"
        numbers = [name for name in self._values if name not in _TEXTS]
        variables: dict[str, Any] = {}
        for name in (*numbers, *_TEXTS):
            values = self._values[name]
            counts = name in VARIABLES and VARIABLES[name].type == "count"
            whole = values.astype(int) if counts and np.isfinite(values).all() else values.copy()
            variables[name] = dimensions, whole, self._descriptions.get(name, {})
        description = {"long_name": "name of the run's file"}
        variables["run"] = dimensions[:-1], self._runs.copy(), description
        coordinates: dict[str, Any] = {
            key: (dimension, *coordinate)
            for key, (dimension, coordinate) in self._study.coordinates().items()
        }
        counted = {"long_name": "load step, counted from 1"}
        coordinates["step"] = "step", np.arange(1, self._values["status"].shape[-1] + 1), counted
        table = with_path(xr.Dataset(variables, coordinates, self._attributes))
        if not numbers:
            return table
        return derive(table, self._study.derived, units_of(self._study.points[0].run))

    def write(self, directory: Path, *, at_once: bool = False) -> None:
        """Write the files of the table; if not ``at_once``, in a small share of the time only."""
        start = time.monotonic()
        if at_once or start >= self._next_write:
            self.files = write(self.dataset(), directory)
            end = time.monotonic()
            self._next_write = end + (end - start) / _SHARE_OF_WRITING


def write(table: xr.Dataset, directory: Path) -> tuple[Path, Path]:
    """Write ``study.h5`` and ``study.csv`` and return their paths."""
    whole, text = directory / "study.h5", directory / "study.csv"
    storage.write(with_python_names(table), whole)
    status = table["status"]
    # A run may have fewer steps than the table.
    exists = status.values.ravel() != ""
    columns = []
    for name in ("run", *table.coords, *(n for n in table.data_vars if n not in ("run", CAVEATS))):
        values = table[name].broadcast_like(status).transpose(*status.dims).values.ravel()[exists]
        columns.append(Column(str(name), values.tolist(), table[name].attrs.get("units", "")))
    write_csv(Table(columns), text)
    return whole, text


def check_outputs(study: Study) -> None:
    """Refuse settings of outputs that do not fit the axes, runs and numbers of a study."""
    runs = _planned(study)
    for number, output in enumerate(study.points[0].run.outputs or ()):
        if output.scope == "run":
            continue
        field = f"outputs.{number}"
        with problems_within(field), errors_attributed_to(output), np.errstate(all="ignore"):
            output.check(runs)


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
        where = *position, [run.steps - 1]
        row = table.isel(dict(zip(steps.dims, where, strict=True))).reset_coords(drop=True)
        fields = FIELDS if run.load is None else FIELDS_OF_LOAD
        for field in (*fields, *[WALL_PRESSURE] * bool(run.interaction)):
            cells = np.zeros((1, 2, 2), bool if VARIABLES[field].type == "truth" else float)
            row[field] = ("step", *CELLS), cells, VARIABLES[field].attributes
        sides = [edge / 4 * np.array([-1, 1]) for edge in run.grid.size]
        row = row.assign_coords(dict(zip(CELLS, sides, strict=True)))
        return row.assign_attrs(configuration=run.to_json(), **facts_of([run]))

    return StoredRuns(derive(table, study.derived, {}), last_step, study.to_json(portable=True))
