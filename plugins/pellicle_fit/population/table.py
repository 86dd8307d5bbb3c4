"""The table of a population, with a row for each curve."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .row import Row, units_of

if TYPE_CHECKING:
    import xarray as xr

_MEASURED = {"spring_constant": "N/m", "sensitivity": "m/V", "poissons_ratio": "1"}
"""Numbers in the data of a row, and their units."""
_COUNTS = "failed_checks", "messages"


def table(rows: Sequence[Row]) -> xr.Dataset:
    """Return rows as a dataset over ``curve``; NaN where there is no number.

    Each quantity has its value and the ends of its interval, such as ``tension_low``.
    """
    import pandas as pd
    import xarray as xr

    cells = [_cells(row) for row in rows]
    # The curve with the most quantities gives the order of the columns.
    names = list(dict.fromkeys(name for one in sorted(cells, key=len)[::-1] for name in one))
    frame = pd.DataFrame(cells, columns=names)
    units = {"x": "m", "y": "m", **_MEASURED, **units_of(rows)}
    columns: dict[str, Any] = {}
    for name, column in frame.items():
        if name in units and name not in _COUNTS:
            columns[str(name)] = "curve", column.to_numpy(float), {"units": units[str(name)]}
        else:
            columns[str(name)] = "curve", column.fillna("").to_numpy()
    names_of = np.array([row.name for row in rows], dtype=object)
    return xr.Dataset(columns, {"curve": names_of})


def _cells(row: Row) -> dict[str, Any]:
    """Return the cells of a curve by the names of their columns, in SI."""
    data, fit = row.data, row.fit
    numbers = {name: value for name, value in row.values().items() if name not in _COUNTS}
    cells = {"status": row.status, **numbers, "model": row.model}
    cells |= {name: fit.get(name, "") for name in ("verdict", "comparison", "advice")}
    cells |= {"group": row.group, "accepted": row.accepted, "outlier": row.outlier}
    cells["reason"] = row.reason
    if row.site is not None:
        cells |= {"map": row.map, "x": row.site.x, "y": row.site.y}
    cells["failed_checks"] = "; ".join(row.failed_checks)
    cells |= {name: data.get(name) for name in _MEASURED}
    cells |= {name: data.get(name) or "" for name in ("segment", "baseline", "file", "sha256")}
    roles = data.get("columns", {}).items()
    cells["columns"] = "; ".join(f"{role} = {column}" for role, column in roles)
    return cells | {"messages": "; ".join(row.messages)}
