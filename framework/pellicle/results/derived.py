"""Numbers derived from a table of runs, from the fields of the runs and their configuration."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.errors import ConfigError, StorageError, shown
from pellicle.model.expression import evaluate, names_in
from pellicle.model.paths import walk

from . import storage
from .variables import FIELDS

if TYPE_CHECKING:
    import xarray as xr

    from .result import Result

_CELLS = ["x", "y"]
REDUCTIONS: dict[str, Callable[[Any], Any]] = {
    "mean": lambda field: field.mean(_CELLS),
    "sum": lambda field: field.sum(_CELLS),
    "min": lambda field: field.min(_CELLS),
    "max": lambda field: field.max(_CELLS),
}
"""Functions that reduce a field to one number for each step."""


FIRST_RUN = "first_run"
"""Attribute of the table of a study: the configuration of its first run, JSON, SI."""


def names(data: xr.Dataset) -> dict[str, Any]:
    """Return the values that expressions over a result or the table of a study may name.

    These are its numeric variables and coordinates, and the numbers of its configuration by their
    dotted path, such as ``kernel.tension`` or ``grid.size.0``, unless a coordinate varies them.
    """
    configuration = json.loads(data.attrs.get(FIRST_RUN, data.attrs["configuration"]))
    varied = tuple(f"{name}." for name in data.coords)
    fixed = {
        key: value for key, value in constants(configuration).items() if not key.startswith(varied)
    }
    numeric = {str(name): data[name] for name in data.variables if data[name].dtype.kind in "iuf"}
    # numpy does not subtract truth values.
    truths = {
        str(name): data[name].astype(float)
        for name in data.variables
        if data[name].dtype.kind == "b"
    }
    return {**fixed, **numeric, **truths}


def derive(table: xr.Dataset, expressions: Mapping[str, str]) -> xr.Dataset:
    """Return the table of a study with further columns, which may name earlier ones.

    Raises
    ------
    ConfigError
        An expression is not arithmetic, or a name in it is unknown.
    """
    for name, text in expressions.items():
        table = table.assign({name: 0.0 * table["converged"] + evaluate(text, names(table))})
        table[name].attrs = {"long_name": text}
    return table


def constants(configuration: object) -> dict[str, float]:
    """Return the numbers of a configuration by their dotted path."""
    return {
        path: float(value)
        for path, value, _ in walk(configuration)
        if isinstance(value, (int, float)) and not isinstance(value, bool)
    }


def as_array(text: str, data: xr.Dataset) -> xr.DataArray:
    """Return the value of an expression over a result or a table as an array.

    Raises
    ------
    ConfigError
        The text is not arithmetic, or a name in it is unknown.
    """
    import xarray as xr

    value = evaluate(text, names(data))
    return value if isinstance(value, xr.DataArray) else xr.DataArray(value)


def _by_step(text: str, run: xr.Dataset) -> Any:
    """Return the value for each step of an expression over a run with reduced fields."""
    value = evaluate(text, names(run), REDUCTIONS)
    if set(getattr(value, "dims", ())) & set(_CELLS):
        raise ConfigError(
            f"{shown(text)} has a value for each cell, and one for each step is drawn; put fields, "
            f"x and y inside {', '.join(REDUCTIONS)}, such as mean(pressure)"
        )
    return value


@dataclass(frozen=True)
class Runs:
    """A table of runs, and access to the fields of each."""

    table: xr.Dataset
    """Numbers of each run and step; ``run`` names the runs."""
    open: Callable[[str], xr.Dataset]
    """Returns the dataset of a run by its name, or raises StorageError."""

    @classmethod
    def of_result(cls, result: Result) -> Runs:
        """Return the one run of a result, as a table of its steps."""
        data = result.dataset
        return cls(data.drop_dims(_CELLS).assign(run=((), "")), lambda _: data)

    @classmethod
    def of_study(cls, table: xr.Dataset, directory: Path) -> Runs:
        """Return the runs of the study whose folder is ``directory``."""
        return cls(table, lambda name: storage.read(directory / "runs" / f"{name}.h5"))

    def each(self) -> Iterator[tuple[tuple[int, ...], xr.Dataset | None]]:
        """Yield the index in the table and the dataset of each run; None for one without a file."""
        for index, name in np.ndenumerate(self.table["run"].values):
            try:
                yield index, self.open(str(name))
            except StorageError:
                yield index, None

    def column(self, text: str) -> xr.DataArray:
        """Return the value of an expression over the table, with fields reduced to numbers.

        Raises
        ------
        ConfigError
            The text is not arithmetic, or a name in it is unknown.
        """
        if names_in(text) & {*FIELDS, *_CELLS}:
            return self.from_each(lambda run: _by_step(text, run))
        return as_array(text, self.table)

    def from_each(self, measure: Callable[[xr.Dataset], Any]) -> xr.DataArray:
        """Return ``measure`` of each run, a number for each step; NaN where there is no run."""
        import xarray as xr

        runs, steps = self.table["run"], self.table.sizes["step"]
        values = np.full((*runs.shape, steps), np.nan)
        for index, data in self.each():
            if data is not None:
                values[index][: data.sizes["step"]] = measure(data)
        coords = {dim: self.table[dim] for dim in (*runs.dims, "step")}
        return xr.DataArray(values, coords, (*runs.dims, "step"))
