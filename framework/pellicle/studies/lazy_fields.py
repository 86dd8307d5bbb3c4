"""Fields of all runs of a study as arrays that are read from the runs' files when used."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from xarray import Variable
from xarray.backends import BackendArray
from xarray.core import indexing

from pellicle.arrays import Mask
from pellicle.errors import StorageError
from pellicle.results import netcdf, storage
from pellicle.results.path import has_interaction
from pellicle.results.variables import FIELDS, VARIABLES, WALL_PRESSURE

if TYPE_CHECKING:
    import xarray as xr


def add_fields(table: xr.Dataset, runs: Path) -> xr.Dataset:
    """Return the table of a study with the fields of its runs, which are read when used.

    The dimensions of the fields are those of the table, x and y. Fields of missing steps are NaN,
    or False for ``contact``; the wall pressure, where there is an interaction, is a field too.

    Raises
    ------
    StorageError
        No run of the study has a finished step.
    """
    exists = ~np.isnan(table["force"].values) if "force" in table else np.array(False)
    if not exists.any():
        raise StorageError(f"{runs} has no step of this study; see the status of its runs")
    first = np.argwhere(exists.any(axis=-1))[0]
    with storage.opened(runs / f"{table['run'].values[tuple(first)]}.h5") as file:
        cells = netcdf.dataset(file, without=["step"])
    dimensions = [*table["status"].dims, "x", "y"]
    shape = *exists.shape, cells.sizes["x"], cells.sizes["y"]
    fields = {}
    pulls = ~np.isnan(table["zone_area"].values) if has_interaction(table) else np.array(False)
    for name in (*FIELDS, *[WALL_PRESSURE] * bool(pulls.any())):
        steps = pulls if name == WALL_PRESSURE else exists
        array = _Field(runs, table["run"].values, steps, name, shape)
        lazy = indexing.LazilyIndexedArray(array)
        fields[name] = Variable(dimensions, lazy, VARIABLES[name].attributes)
    return table.assign_coords(x=cells["x"], y=cells["y"]).assign(fields)


class _Field(BackendArray):
    """One field of all runs: (*dimensions of the study, step, x, y)."""

    def __init__(
        self,
        runs: Path,
        names: np.ndarray[Any, np.dtype[Any]],
        exists: Mask,
        name: str,
        shape: tuple[int, ...],
    ) -> None:
        self._runs, self._names, self._exists, self._name = runs, names, exists, name
        self.shape = shape
        self.dtype = np.dtype(bool if name == "contact" else float)

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(
            key, self.shape, indexing.IndexingSupport.BASIC, self._read
        )

    def _read(self, key: tuple[int | slice, ...]) -> Any:
        *of_steps, x, y = key
        exists = self._exists[tuple(of_steps)]
        indices = np.indices(self._exists.shape)[(slice(None), *of_steps)]
        missing = False if self.dtype == bool else np.nan
        cells = np.empty(self.shape[-2:], dtype=bool)[x, y].shape
        read = np.full((*exists.shape, *cells), missing, dtype=self.dtype)
        for position in np.argwhere(exists):
            *run, step = indices[(slice(None), *position)].tolist()
            path = self._runs / f"{self._names[tuple(run)]}.h5"
            read[tuple(position)] = storage.fields(path, [self._name], step)[1][0][x, y]
        return read
