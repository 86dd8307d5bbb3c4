"""The fits of a population, their table, and the quartiles of each group of curves."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from pellicle_fit.estimation.intervals import threshold_of
from pellicle_fit.record import ENDS, OVER_TIED

from .row import SHOWN, Row, units

QUARTILES = "minimum", "lower_quartile", "median", "upper_quartile", "maximum"
_MEASURED = {"spring_constant": "N/m", "sensitivity": "m/V", "poissons_ratio": "1"}
"""Numbers in the data of a row, and their units."""
_COUNTS = "failed_checks", "messages"
_NAMES = (*OVER_TIED, *(name for name in SHOWN if name not in OVER_TIED))
"""Quantities that have quartiles."""


@dataclass
class ManyFits:
    """The fits of many curves."""

    rows: list[Row]
    files: tuple[Path, ...] = ()
    left: int = 0
    """Number of curves that other parts have to fit before there is a table."""
    resumed: int = 0
    """Number of fits that an earlier call had finished."""
    notes: list[str] = field(default_factory=list)
    """Notes on the population: changed files, rejected curves, lists with wrong names."""
    maps: dict[str, xr.Dataset] = field(default_factory=dict)
    """Images of each force map, by its file."""
    configuration: dict[str, Any] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Return the fits as JSON data."""
        curves = [row.to_dict() for row in self.rows]
        return {"curves": curves, "groups": summary(self.rows), "notes": self.notes}


def table(rows: Sequence[Row]) -> xr.Dataset:
    """Return rows as a dataset over ``curve``; NaN where there is no number.

    Each quantity has its value and the ends of its interval, such as ``tension_low``.
    """
    cells = [_cells(row) for row in rows]
    # The curve with the most quantities gives the order of the columns.
    names = list(dict.fromkeys(name for one in sorted(cells, key=len)[::-1] for name in one))
    unit_of = {"x": "m", "y": "m", **_MEASURED, **units()}
    columns: dict[str, Any] = {}
    for name, column in pd.DataFrame(cells, columns=names).items():
        if name in unit_of and name not in _COUNTS:
            columns[str(name)] = "curve", column.to_numpy(float), {"units": unit_of[str(name)]}
        else:
            columns[str(name)] = "curve", column.fillna("").to_numpy()
    return xr.Dataset(columns, {"curve": np.array([row.name for row in rows], dtype=object)})


def _cells(row: Row) -> dict[str, Any]:
    """Return the cells of a curve by the names of their columns, in SI."""
    fit, data, texts = row.fit, row.fit.curve.get("data", {}), ("verdict", "comparison")
    place = {} if row.site is None else {"map": row.map, "x": row.site.x, "y": row.site.y}
    roles = data.get("columns", {}).items()
    # What an explanation has none of, and what has no bound, would pass for a measured value.
    unknown = [
        name
        for name, e in fit.estimates().items()
        if (e.held and not e.value) or (not e.held and e.low is None is e.high)
    ]
    hidden = [*_COUNTS, *(f"{name}{end}" for name in unknown for end in ENDS)]
    return {
        "status": row.status,
        **{name: value for name, value in fit.values().items() if name not in hidden},
        "model": fit.data["model"]["words"] if fit else "",
        **{name: fit.data.get(name, "") for name in texts},
        "next": "; ".join("{do}: {why}".format(**step) for step in fit.steps),
        **{name: getattr(row, name) for name in ("group", "accepted", "outlier", "reason")},
        **place,
        "not_weighed": "; ".join(map(" + ".join, fit.data.get("not_weighed", ()))),
        "failed_checks": "; ".join(fit.failed_checks),
        **{name: data.get(name) for name in _MEASURED},
        **{name: data.get(name) or "" for name in ("segment", "baseline", "file", "sha256")},
        "columns": "; ".join(f"{role} = {column}" for role, column in roles),
        "messages": "; ".join(fit.messages),
    }


def summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Return a line for each parameter and group that has an accepted curve, then for all curves.

    Of all ``curves`` of a group ``n`` are accepted. Quartiles are of the best values of all of
    these, of which ``open`` have an interval with an open end, or quote no value, and ``no_sign``
    show no sign of what has the parameter.  Parameters that were fixed have no line.  Where curves
    share an error of the calibration that moves the median, there is a ``common_error``.
    """
    # A row is unpacked once for all names.
    fitted = [
        (name, row.group, best, own, fit.has_no_sign(name), row.outlier, fit.common_errors(name))
        for row in rows
        if row.accepted
        for fit in (row.fit,)
        for name in _NAMES
        if (own := fit.estimates().get(name)) and (best := fit.best(name))
    ]
    columns = "parameter", "group", "best", "own", "no_sign", "outlier", "errors"
    frame = pd.DataFrame(fitted, columns=columns)
    curves, lines = Counter(row.group for row in rows), []
    for name in _NAMES:
        whole = frame[frame["parameter"] == name]
        if all(e.held for e in whole["own"]):
            continue
        groups = whole.groupby("group", sort=False) if len(curves) > 1 else ()
        parts = [(label(group), curves[group], part) for group, part in groups]
        for group, count, part in (*parts, ("all", len(rows), whole)):
            estimates, values = [*part["own"]], pd.Series([e.value for e in part["best"]])
            line = {
                "group": group,
                "parameter": name,
                "unit": estimates[0].unit,
                "curves": count,
                "n": len(part),
                "open": sum(not e.is_narrow for e in estimates),
                "no_sign": int(part["no_sign"].sum()),
                "outliers": int(part["outlier"].sum()),
                **dict(zip(QUARTILES, values.quantile([0, 0.25, 0.5, 0.75, 1]), strict=True)),
            }
            lines.append(line | common_error(part["errors"]))
    return lines


def common_error(errors: Iterable[dict[str, float]]) -> dict[str, float]:
    """Return the ``common_error`` of the median of a quantity, nothing if no curve has one.

    It is half of a 95 % interval [SI]: by so much the calibration that curves share may move all.
    """
    moved = pd.DataFrame([*errors])
    deviation = float(np.sqrt((moved.fillna(0.0).median() ** 2).sum()))
    return {"common_error": threshold_of(np.inf) ** 0.5 * deviation} if deviation else {}


def label(group: str) -> str:
    """Return the name of a group in tables and figures."""
    return group or "no group"
