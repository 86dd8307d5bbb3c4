"""The table of a population, with a row for each curve."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from .judgement import Row
from .rules import NUMBERS

if TYPE_CHECKING:
    import xarray as xr

_MEASURED = {"spring_constant": "N/m", "sensitivity": "m/V", "poissons_ratio": "1"}
"""Numbers in the data of a row, and their units."""


def table(rows: list[Row]) -> xr.Dataset:
    """Return rows as a dataset over ``curve``; NaN where there is no number."""
    import xarray as xr

    def texts(values: Iterable[str]) -> tuple[str, Any]:
        return "curve", np.array(list(values), dtype=object)

    def numbers(values: Iterable[float | None], unit: str = "1") -> tuple[str, Any, dict[str, str]]:
        return "curve", np.array(list(values), dtype=float), {"units": unit}

    columns: dict[str, Any] = {"status": texts(row["status"] for row in rows)}
    units = {
        name: value["unit"]
        for row in rows
        for name, value in row.items()
        if isinstance(value, dict) and "unit" in value
    }
    for name, unit in units.items():
        columns[name] = numbers((row.get(name, {}).get("value") for row in rows), unit)
        for end in ("low", "high", "bound"):
            column = numbers((row.get(name, {}).get(end) for row in rows), unit)
            if np.isfinite(column[1]).any():
                columns[f"{name}_{end}"] = column
    for name in ("points", "noise", "chi_squared", "r_squared", "indentation", "largest_force"):
        if name not in columns:
            columns[name] = numbers((row.get(name) for row in rows), NUMBERS[name])
    columns["chosen_model"] = texts(row.get("chosen", {}).get("model", "") for row in rows)
    chosen = [row.get("chosen", {}).get("parameters", {}).get("reduced_modulus") for row in rows]
    for end in ("value", "low", "high"):
        name = f"chosen_reduced_modulus{'' if end == 'value' else f'_{end}'}"
        columns[name] = numbers((e and e[end] for e in chosen), "Pa")
    for name, unit in (("reduced_modulus", "Pa"), ("tension", "N/m")):
        tied = [row.get("rivals", {}).get(name) or {} for row in rows]
        for end in ("low", "high"):
            columns[f"tied_{name}_{end}"] = numbers((e.get(end) for e in tied), unit)
    columns["tension_needed"] = numbers(row.get("tension_needed") for row in rows)
    for name in ("delta_chi_squared", "delta_aic"):
        columns[name] = numbers(row.get("without_tension", {}).get(name) for row in rows)
    columns["group"] = texts(row["group"] for row in rows)
    for name in ("accepted", "outlier"):
        columns[name] = "curve", np.array([row[name] for row in rows], dtype=bool)
    columns["reason"] = texts(row["reason"] for row in rows)
    if any("site" in row for row in rows):
        columns["map"] = texts(row.get("site", {}).get("map", "") for row in rows)
        for name in ("x", "y"):
            columns[name] = numbers((row.get("site", {}).get(name) for row in rows), "m")
    for name in ("comparison", "advice"):
        columns[name] = texts(row.get(name, "") for row in rows)
    checks = [[check["code"] for check in row.get("failed_checks", ())] for row in rows]
    columns["failed_checks"] = texts(map("; ".join, checks))
    data = [row.get("data", {}) for row in rows]
    for name, unit in _MEASURED.items():
        columns[name] = numbers((entry.get(name) for entry in data), unit)
    for name in ("segment", "baseline", "file", "sha256"):
        columns[name] = texts(entry.get(name) or "" for entry in data)
    roles = [entry.get("columns", {}).items() for entry in data]
    columns["columns"] = texts("; ".join(f"{r} = {c}" for r, c in items) for items in roles)
    columns["messages"] = texts("; ".join(row.get("messages", ())) for row in rows)
    return xr.Dataset(columns, {"curve": texts(row["curve"] for row in rows)})
