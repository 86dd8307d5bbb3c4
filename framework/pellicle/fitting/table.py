"""The table of many fits: a row for each curve."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.files import atomic_write
from pellicle.results import storage
from pellicle.results.variables import header

from .written import write_json

if TYPE_CHECKING:
    import xarray as xr

FITTED = "fitted"
FAILED = "failed: "
NOT_RUN = "not run"
_ENDS = ("low", "high", "bound")
_TEXTS = ("comparison", "advice")


def table(rows: list[dict[str, Any]]) -> xr.Dataset:
    """Return rows as a dataset over ``curve``; NaN where there is no number."""
    import xarray as xr

    columns: dict[str, tuple[str, list[Any], dict[str, str]]] = {
        "status": ("curve", [row["status"] for row in rows], {}),
    }
    units = {
        name: said["unit"]
        for row in rows
        for name, said in row.items()
        if isinstance(said, dict) and "unit" in said
    }
    for name, unit in units.items():
        for key in ("value", *_ENDS):
            values = [_number(row.get(name, {}).get(key)) for row in rows]
            if key == "value" or np.isfinite(values).any():
                label = name if key == "value" else f"{name}_{key}"
                columns[label] = ("curve", values, {"units": unit})
    for name in ("points", "chi_squared", "tension_needed"):
        columns[name] = ("curve", [_number(row.get(name)) for row in rows], {"units": "1"})
    for name in ("delta_chi_squared", "delta_aic"):
        gains = [_number(row.get("without_tension", {}).get(name)) for row in rows]
        columns[name] = ("curve", gains, {"units": "1"})
    for name in _TEXTS:
        columns[name] = ("curve", [row.get(name, "") for row in rows], {})
    codes = ["; ".join(check["code"] for check in row.get("failed_checks", ())) for row in rows]
    columns["failed_checks"] = ("curve", codes, {})
    columns["messages"] = ("curve", ["; ".join(row.get("messages", ())) for row in rows], {})
    variables = {
        name: (
            dimension,
            np.array(values, dtype=object if isinstance(values[0], str) else float),
            said,
        )
        for name, (dimension, values, said) in columns.items()
    }
    names = np.array([row["curve"] for row in rows], dtype=object)
    return xr.Dataset(variables, {"curve": ("curve", names)})


def _number(value: float | None) -> float:
    return float("nan") if value is None else float(value)


def write(rows: list[dict[str, Any]], directory: Path) -> tuple[Path, ...]:
    """Write ``fits.h5``, ``fits.csv`` and ``fits.json`` and return their paths.

    Raises
    ------
    StorageError
        They cannot be written.
    """
    made = table(rows)
    whole, text = directory / "fits.h5", directory / "fits.csv"
    storage.write(made, whole)
    with atomic_write(text) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        columns = ["curve", *made.data_vars]
        writer.writerow(header(str(name), made[name]) for name in columns)
        writer.writerows(zip(*(made[name].values.tolist() for name in columns), strict=True))
    return whole, text, write_json({"curves": rows}, directory / "fits.json")
