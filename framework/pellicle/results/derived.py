"""Numbers computed from the table, the fields and the configuration of runs."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from operator import methodcaller
from typing import Any

from pellicle.arrays import DataArray, Dataset
from pellicle.errors import ConfigError
from pellicle.schema.expression import evaluate, names_in
from pellicle.schema.model import walk
from pellicle.units import si_unit, unit_quantity

CELLS = ["x", "y"]
"""Dimensions of a field."""
REDUCTIONS: dict[str, Callable[[Any], Any]] = {
    name: methodcaller(name, CELLS) for name in ("mean", "sum", "min", "max")
}
"""Functions that reduce a field to one number for each step."""
FIRST_RUN = "first_run"
"""Attribute of a study's table: the configuration of the first run as JSON in SI."""
VARYING = "varying"
"""Attribute of a study's table: as JSON, paths of numbers of the first run that others differ in,
beside the axes."""
DERIVED = "derived"
"""Attribute of a study's table: as JSON, the expression of each derived column, by name."""


def configuration_of(data: Dataset) -> dict[str, Any]:
    """Return the configuration of a result, or of the first run of a study, in SI."""
    text = data.attrs.get(FIRST_RUN, data.attrs["configuration"])
    configuration: dict[str, Any] = json.loads(text)
    return configuration


def names(data: Dataset) -> dict[str, Any]:
    """Return the values that expressions over a result or the table of a study may use, by name.

    These are its numeric variables and coordinates, and the numbers of its configuration by their
    dotted path, such as ``kernel.tension`` or ``grid.size.0``, unless they vary in the study.
    """
    varied = tuple(f"{name}." for name in data.coords)
    varying = json.loads(data.attrs.get(VARYING, "[]"))
    fixed = {
        key: value
        for key, value in constants(configuration_of(data)).items()
        if not key.startswith(varied) and key not in varying
    }
    # numpy refuses to subtract bools.
    columns = {
        str(name): data[name].astype(float) if data[name].dtype == bool else data[name]
        for name in data.variables
        if data[name].dtype.kind in "iufb"
    }
    return {**fixed, **columns}


def derive(table: Dataset, expressions: Mapping[str, str], units: Mapping[str, str]) -> Dataset:
    """Return the table of a study with derived columns, which may use earlier ones.

    A column has a value for each step, or one for each run if it uses variables of the path only.
    Its unit follows from those of its variables and of the fields of the configuration, which
    ``units`` has by dotted path; it has none where they do not agree.
    """
    per_run = {
        str(name)
        for name, variable in table.data_vars.items()
        if "step" not in variable.dims and variable.dtype.kind == "f"
    }
    known, columns = names(table), dict[str, DataArray]()
    all_units = {**units, **{str(n): v.attrs.get("units", "1") for n, v in table.variables.items()}}
    for name, text in expressions.items():
        like = table["converged"]
        if names_in(text) & per_run:
            like = like.isel(step=0, drop=True)
        known[name] = columns[name] = column = 0.0 * like + evaluate(text, known)
        if "step" not in column.dims:
            per_run.add(name)
        all_units[name] = _unit_of(text, all_units)
        column.attrs = {"long_name": text, "units": all_units[name]}
    return table.assign(columns)


def _unit_of(text: str, units: Mapping[str, str]) -> str:
    """Return the SI unit of an expression over names with units; ``"1"`` where there is none."""
    quantities = {}
    try:
        for name in names_in(text):
            # An exponent that varies, so that a power has no unit, is NaN here.
            quantities[name] = math.nan * unit_quantity(units.get(name, "1"))
        return si_unit(evaluate(text, quantities))
    except (ConfigError, ValueError):
        # Units that differ, or that of a stranger's variable that pint does not know.
        return "1"


def constants(configuration: object) -> dict[str, float]:
    """Return the numbers of a configuration by their dotted path."""
    return {
        path: float(value)
        for path, value, _ in walk(configuration)
        if isinstance(value, (int, float)) and not isinstance(value, bool)
    }


def as_array(text: str, data: Dataset) -> DataArray:
    """Return the value of an expression over a result or a table as an array."""
    import xarray as xr

    value = evaluate(text, names(data))
    return value if isinstance(value, xr.DataArray) else xr.DataArray(value)


def header(name: str, variable: DataArray) -> str:
    """Return the header of a variable's column in a file: its name and SI unit."""
    unit = variable.attrs.get("units", "1")
    return name if unit == "1" else f"{name} [{unit}]"
