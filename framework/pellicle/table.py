"""The table of a study: what its runs say, over the parameters that vary."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import storage
from .columns import FIRST_RUN, derive
from .dataset import header
from .provenance import now_with
from .result import Status
from .study_config import Study
from .text_files import for_document

if TYPE_CHECKING:
    import xarray as xr

NOT_RUN = "not run"


class Table:
    """Takes the numbers of the runs as they finish, and makes the dataset of what is there."""

    def __init__(self, study: Study) -> None:
        self._study = study
        self._attributes = {
            "title": for_document(study.points[0].run.title),
            "configuration": study.to_json(),
            FIRST_RUN: study.points[0].run.to_json(as_given=True),
            "axes": json.dumps({name: list(axes) for name, axes in study.dimensions.items()}),
            **now_with(point.run for point in study.points),
        }
        steps = {point.place: len(point.run.loading.values) for point in study.points}
        shape = *study.shape, max(steps.values())
        self._status = np.full(shape, "", dtype=object)
        self._runs = np.full(study.shape, "", dtype=object)
        for point in study.points:
            self._status[point.place][: steps[point.place]] = NOT_RUN
            self._runs[point.place] = point.run.identity[:16]
        self._numbers: dict[str, np.ndarray[Any, np.dtype[Any]]] = {}
        self._said: dict[str, dict[str, str]] = {}

    def put(self, index: tuple[int, ...], scalars: xr.Dataset) -> None:
        """Take the steps that a run has."""
        count = scalars.sizes["step"]
        for name, variable in scalars.data_vars.items():
            self._said.setdefault(str(name), dict(variable.attrs))
            if name == "status":
                self._status[index][:count] = variable.values
                continue
            missing = False if variable.dtype == bool else np.nan
            kept = self._numbers.setdefault(str(name), np.full(self._status.shape, missing))
            kept[index][:count] = variable.values

    def fail(self, index: tuple[int, ...], message: str) -> None:
        """Say why a run has no more steps."""
        status = self._status[index]
        status[status == NOT_RUN] = message

    def dataset(self) -> xr.Dataset:
        """Return the table, NaN where there is no number."""
        import xarray as xr

        dimensions = *self._study.dimensions, "step"
        variables: dict[str, Any] = {
            name: (dimensions, _whole(values, name), self._said[name])
            for name, values in self._numbers.items()
        }
        variables["status"] = dimensions, self._status.copy(), self._said.get("status", {})
        about = {"long_name": "name of the run's file"}
        variables["run"] = dimensions[:-1], self._runs.copy(), about
        coordinates: dict[str, Any] = {
            key: (dimension, made.values, made.attributes)
            for key, (dimension, made) in self._study.coordinates().items()
        }
        coordinates["step"] = (
            "step",
            np.arange(self._status.shape[-1]),
            {"long_name": "load step"},
        )
        made = xr.Dataset(variables, coordinates, self._attributes)
        return derive(made, self._study.derived) if self._numbers else made


_COUNTS = ("iterations", "operator_applications", "patches")


def _whole(values: np.ndarray[Any, np.dtype[Any]], name: str) -> np.ndarray[Any, np.dtype[Any]]:
    """Return a copy, in whole numbers where they count something and none is missing."""
    return values.astype(int) if name in _COUNTS and np.isfinite(values).all() else values.copy()


def damage(table: xr.Dataset) -> str:
    """Return what keeps a dataset from being the table of a study."""
    numbers = any(variable.dtype.kind in "fiu" for variable in table.data_vars.values())
    expected = {"status", "run", "converged"} if numbers else {"status", "run"}
    if missing := expected - {*map(str, table.data_vars)}:
        return f"lacks {', '.join(sorted(missing))}"
    for name, variable in table.data_vars.items():
        kinds = "UO" if name in ("status", "run") else "b" if name == "converged" else "fiub"
        if variable.dtype.kind not in kinds:
            return f"has {name} of type {variable.dtype}"
    try:
        study, axes, run = (
            json.loads(table.attrs[name]) for name in ("configuration", "axes", FIRST_RUN)
        )
        known = all(isinstance(part, dict) for part in (study["study"], axes, run))
    except (LookupError, TypeError, ValueError):
        known = False
    if not known:
        return "does not say which study it is of"
    return ""


def verdict(status: str) -> str:
    """Return one word for the status of a step in a table."""
    if status in ("", NOT_RUN):
        return status
    begins = {Status.CONVERGED.value: "converged", FAILED: "failed"}
    return next((begins[head] for head in begins if status.startswith(head)), "NOT CONVERGED")


FAILED = "failed: "


def write(table: xr.Dataset, directory: Path) -> tuple[Path, Path]:
    """Write ``study.h5`` and ``study.csv`` and return their paths.

    Raises
    ------
    StorageError
        They cannot be written.
    """
    whole, text = directory / "study.h5", directory / "study.csv"
    storage.write(table, whole)
    with storage.aside(text) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        columns = ["run", *table.coords, *(n for n in table.data_vars if n != "run")]
        writer.writerow(header(str(name), table[name]) for name in columns)
        status = table["status"]
        spread = [
            table[name].broadcast_like(status).transpose(*status.dims).values.ravel()
            for name in columns
        ]
        there = spread[columns.index("status")] != ""
        writer.writerows(zip(*(column[there].tolist() for column in spread), strict=True))
    return whole, text
