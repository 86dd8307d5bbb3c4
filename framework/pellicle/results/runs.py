"""The runs that an output shows, one or all of a study, and how far each is."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import DataArray, Dataset
from pellicle.contact.caveats import Status
from pellicle.errors import ConfigError, StorageError, excerpt
from pellicle.schema.expression import evaluate, names_in
from pellicle.variables import FIELDS, WALL_PRESSURE

from . import storage
from .derived import CELLS, REDUCTIONS, as_array, names
from .dimensions import parts, with_paths
from .path import with_path


@dataclass(frozen=True)
class StoredRuns:
    """A `pellicle.Runs` for outputs, from the datasets of its runs."""

    table: Dataset
    source: Callable[[str], Dataset]
    """Function that returns the dataset of a run by name, or raises StorageError."""
    configuration: str = "{}"

    @classmethod
    def of_run(cls, dataset: Dataset, configuration: str = "{}") -> StoredRuns:
        """Return a single run, given its result."""
        table = with_path(dataset.drop_dims(CELLS)).assign(run=((), ""))
        return cls(table, lambda _: dataset, configuration)

    @classmethod
    def of_study(cls, table: Dataset, directory: Path, configuration: str = "{}") -> StoredRuns:
        """Return the runs of the study whose folder is ``directory``."""
        return cls(
            with_paths(table),
            lambda name: storage.read(directory / "runs" / f"{name}.h5"),
            configuration,
        )

    @property
    def axes(self) -> tuple[str, ...] | None:
        """The dimensions of a study; None for a run."""
        axes = self.table.attrs.get("axes")
        return None if axes is None else tuple(json.loads(axes))

    def open(self, name: str = "") -> Dataset:
        """Return all numbers and fields of a run."""
        return self.source(name)

    def datasets(self) -> Iterator[tuple[tuple[int, ...], Dataset | None]]:
        """Yield the index in the table and the dataset of each run; None for a missing file."""
        for index, name in np.ndenumerate(self.table["run"].values):
            try:
                yield index, self.open(str(name))
            except StorageError:
                yield index, None

    def column(self, text: str) -> DataArray:
        """Return the value of an expression for each step."""
        if not names_in(text) & {*FIELDS, WALL_PRESSURE, *CELLS}:
            return as_array(text, self.table)

        def by_step(run: Dataset) -> Any:
            value = evaluate(text, names(run), REDUCTIONS)
            if set(getattr(value, "dims", ())) & set(CELLS):
                raise ConfigError(
                    f"{excerpt(text)} has a value for each cell instead of each step; put fields, "
                    f"x and y inside {', '.join(REDUCTIONS)}, such as mean(pressure)"
                )
            return value

        return self.from_each(by_step)

    def from_each(self, function: Callable[[Dataset], Any]) -> DataArray:
        """Return the values of ``function`` for all steps of all runs; NaN for missing runs."""
        import xarray as xr

        runs, steps = self.table["run"], self.table.sizes["step"]
        values = np.full((*runs.shape, steps), np.nan)
        for index, data in self.datasets():
            if data is not None:
                values[index][: data.sizes["step"]] = function(data)
        coords = {dim: self.table[dim] for dim in (*runs.dims, "step")}
        return xr.DataArray(values, coords, (*runs.dims, "step"))


_LETTERS = 8
_WORST_FIRST = "failed", "not run", "NOT CONVERGED"


def axes_of(table: Dataset) -> list[str]:
    """Return the varied parameters of a study, given its table."""
    return [str(name) for name in table.coords if name != "step"]


def runs_of(table: Dataset) -> Iterator[Dataset]:
    """Yield the part of the table of a study that belongs to each run."""
    return parts(table, table["run"].dims)


def short_files(table: Dataset) -> list[str]:
    """Return the beginnings of the names of the files of runs."""
    return [f"{name[:_LETTERS]}…" for name in table["run"].values.ravel()]


def progress_of(run: Dataset) -> tuple[int, int, str]:
    """Return the number of finished steps, of planned steps, and the worst verdict of a run."""
    (statuses,) = statuses_of(run)
    verdicts = {status.verdict for status in statuses}
    worst = next((verdict for verdict in _WORST_FIRST if verdict in verdicts), "converged")
    done = sum(status not in (Status.NOT_RUN, Status.FAILED) for status in statuses)
    return done, len(statuses), worst


def statuses_of(table: Dataset) -> list[list[Status]]:
    """Return the statuses of the steps of each run."""
    return [[Status[code] for code in run if code] for run in by_run(table, "status_code")]


def by_run(table: Dataset, name: str) -> NDArray[Any]:
    """Return a variable of the steps, of shape (runs, steps)."""
    values = table[name].values
    return values.reshape(-1, values.shape[-1])
