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
_Column = tuple[Any, ...]
"""Dimension, values of shape (curves,) and, of numbers, attributes."""
_Columns = dict[str, _Column]


def table(rows: list[Row]) -> xr.Dataset:
    """Return rows as a dataset over ``curve``; NaN where there is no number."""
    import xarray as xr

    columns = {
        "status": _texts(row["status"] for row in rows),
        **_of_fits(rows),
        **_of_models(rows),
        **_of_judgement(rows),
        **_of_sites(rows),
        **_of_data(rows),
        "messages": _texts("; ".join(row.get("messages", ())) for row in rows),
    }
    return xr.Dataset(columns, {"curve": _texts(row["curve"] for row in rows)})


def _texts(values: Iterable[str]) -> _Column:
    return "curve", np.array(list(values), dtype=object)


def _numbers(values: Iterable[float | None], unit: str = "1") -> _Column:
    return "curve", np.array(list(values), dtype=float), {"units": unit}


def _of_fits(rows: list[Row]) -> _Columns:
    """Return the estimates of the model of each curve, and how well it describes the curve."""
    columns: _Columns = {}
    units = {
        name: value["unit"]
        for row in rows
        for name, value in row.items()
        if isinstance(value, dict) and "unit" in value
    }
    for name, unit in units.items():
        columns[name] = _numbers((row.get(name, {}).get("value") for row in rows), unit)
        for end in ("low", "high", "bound"):
            column = _numbers((row.get(name, {}).get(end) for row in rows), unit)
            if np.isfinite(column[1]).any():
                columns[f"{name}_{end}"] = column
    for name in ("points", "noise", "chi_squared", "r_squared", "indentation", "largest_force"):
        if name not in columns:
            columns[name] = _numbers((row.get(name) for row in rows), NUMBERS[name])
    return columns


def _of_models(rows: list[Row]) -> _Columns:
    """Return the model chosen for each curve, its modulus, and the evidence of a tension."""
    columns = {"chosen_model": _texts(row.get("chosen", {}).get("model", "") for row in rows)}
    for key, end in (("value", ""), ("low", "_low"), ("high", "_high")):
        moduli = (row.get("reduced_modulus", {}).get(key) for row in rows)
        columns[f"chosen_reduced_modulus{end}"] = _numbers(moduli, "Pa")
    for name, unit in (("reduced_modulus", "Pa"), ("tension", "N/m")):
        tied = [row.get("rivals", {}).get(name) or {} for row in rows]
        for end in ("low", "high"):
            columns[f"tied_{name}_{end}"] = _numbers((e.get(end) for e in tied), unit)
    columns["tension_needed"] = _numbers(row.get("tension_needed") for row in rows)
    for name in ("delta_chi_squared", "delta_aic"):
        columns[name] = _numbers(row.get("without_tension", {}).get(name) for row in rows)
    return columns


def _of_judgement(rows: list[Row]) -> _Columns:
    """Return the group of each curve, and whether it was accepted."""
    return {
        "group": _texts(row["group"] for row in rows),
        "accepted": ("curve", np.array([row["accepted"] for row in rows], dtype=bool)),
        "outlier": ("curve", np.array([row["outlier"] for row in rows], dtype=bool)),
        "reason": _texts(row["reason"] for row in rows),
    }


def _of_sites(rows: list[Row]) -> _Columns:
    """Return where in its force map each curve was measured, if any is of one."""
    if not any("site" in row for row in rows):
        return {}
    sites = [row.get("site", {}) for row in rows]
    return {
        "map": _texts(site.get("map", "") for site in sites),
        "x": _numbers((site.get("x") for site in sites), "m"),
        "y": _numbers((site.get("y") for site in sites), "m"),
    }


def _of_data(rows: list[Row]) -> _Columns:
    """Return verdict and failed checks of each curve, and where its data are from."""
    columns = {name: _texts(row.get(name, "") for row in rows) for name in ("comparison", "advice")}
    checks = [[check["code"] for check in row.get("failed_checks", ())] for row in rows]
    columns["failed_checks"] = _texts(map("; ".join, checks))
    data = [row.get("data", {}) for row in rows]
    for name, unit in _MEASURED.items():
        columns[name] = _numbers((entry.get(name) for entry in data), unit)
    for name in ("segment", "baseline", "file", "sha256"):
        columns[name] = _texts(entry.get(name) or "" for entry in data)
    roles = [entry.get("columns", {}).items() for entry in data]
    columns["columns"] = _texts("; ".join(f"{r} = {c}" for r, c in items) for items in roles)
    return columns
