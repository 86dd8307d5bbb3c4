"""Fields of all runs of a study as arrays that read the files of the runs where they are used."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from xarray import Variable
from xarray.backends import BackendArray
from xarray.core import indexing

from pellicle.errors import StorageError
from pellicle.results import netcdf, storage
from pellicle.results.variables import FIELDS

if TYPE_CHECKING:
    import xarray as xr


def add_fields(table: xr.Dataset, runs: Path) -> xr.Dataset:
    """Return the table of a study with the fields of its runs, not read yet.

    Their dimensions are those of the table, x and y; where there is no step they are NaN, and
    False for the contact.

    Raises
    ------
    StorageError
        There is no step at all.
    """
    there = ~np.isnan(table["force"].values) if "force" in table else np.array(False)
    if not there.any():
        raise StorageError(f"{runs} holds no step of this study; see the status of its runs")
    first = np.argwhere(there.any(axis=-1))[0]
    with storage.opened(runs / f"{table['run'].values[tuple(first)]}.h5") as one:
        cells = netcdf.dataset(one, without=["step"])
        attributes = {name: _description(netcdf.attributes(one[name])) for name in FIELDS}
    dimensions = [*table["status"].dims, "x", "y"]
    shape = *there.shape, cells.sizes["x"], cells.sizes["y"]
    fields = {}
    for name in FIELDS:
        array = _Field(runs, table["run"].values, there, name, shape)
        lazy = indexing.LazilyIndexedArray(array)
        fields[name] = Variable(dimensions, lazy, attributes[name])
    return table.assign_coords(x=cells["x"], y=cells["y"]).assign(fields)


def _description(attributes: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in attributes.items() if name in ("long_name", "units")}


class _Field(BackendArray):
    """One field of all runs: (*dimensions of the study, step, x, y)."""

    def __init__(
        self,
        runs: Path,
        names: np.ndarray[Any, np.dtype[Any]],
        there: np.ndarray[Any, np.dtype[np.bool_]],
        name: str,
        shape: tuple[int, ...],
    ) -> None:
        self._runs, self._names, self._there, self._name = runs, names, there, name
        self.shape = shape
        self.dtype = np.dtype(bool if name == "contact" else float)

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(
            key, self.shape, indexing.IndexingSupport.BASIC, self._read
        )

    def _read(self, key: tuple[int | slice, ...]) -> Any:
        *of_steps, x, y = key
        there = self._there[tuple(of_steps)]
        places = np.indices(self._there.shape)[(slice(None), *of_steps)]
        missing = False if self.dtype == bool else np.nan
        cells = np.empty(self.shape[-2:], dtype=bool)[x, y].shape
        read = np.full((*there.shape, *cells), missing, dtype=self.dtype)
        for at in np.argwhere(there):
            *run, step = places[(slice(None), *at)].tolist()
            path = self._runs / f"{self._names[tuple(run)]}.h5"
            read[tuple(at)] = storage.fields(path, [self._name], step)[1][0][x, y]
        return read
