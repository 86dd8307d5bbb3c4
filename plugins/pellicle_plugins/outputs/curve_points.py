"""The points of one curve through the runs of a study: mean and spread, legs, and their limit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from pellicle.analysis import Leg, extrapolate, legs
from pellicle.arrays import DataArray, Dataset
from pellicle.components import Look, Series
from pellicle.errors import ConfigError
from pellicle.results import has_interaction, has_path, has_times

from .base import MOST_LEGS

_GRIDS = 3
"""Fewest grids from which a limit follows."""


def points_of(
    table: Dataset,
    x: DataArray,
    y: DataArray,
    *,
    over: str | None,
    spread: str,
    over_time: bool,
) -> Series:
    """Return the points of one curve, in the order of the table, with the legs of its path.

    These are means, with their ``spread``, along the axis ``over``, if there is one. ``over_time``
    tells a curve against the time, whose legs need no telling apart.
    """
    import xarray as xr

    converged = table["converged"]
    if has_path(table) and "step" not in (*x.dims, *y.dims):
        # Runs may have fewer steps than the table.
        converged = (converged | (table["status"] == "")).all("step")
    x, y, good = xr.broadcast(x, y, converged.astype(float))
    columns = [x, y, y, y, good.fillna(0.0), xr.ones_like(x)]
    if over is not None:
        finished = (x + y).notnull()
        x, y, good = (column.where(finished) for column in (x, y, good))
        middle = x.mean(over), y.mean(over)
        count = finished.sum(over)
        ends = y.min(over), y.max(over)
        if spread != "range":
            squares = ((y - middle[1]) ** 2).sum(over) / (count - 1).clip(min=1)
            half = (squares if spread == "std" else squares / count.clip(min=1)) ** 0.5
            ends = middle[1] - half, middle[1] + half
        columns = [*middle, *ends, good.min(over).fillna(0.0), count]
    values = np.array([column.values.ravel().astype(float) for column in columns])
    values = values[:, finite := np.isfinite(values).all(axis=0)]
    path: list[Leg] = []
    loops = has_interaction(table) or (has_times(table) and not over_time)
    if loops and columns[0].sizes.get("step", 1) > 1 and over is None:
        along = table["depth" if "depth" in table else "time"]
        path = legs(xr.broadcast(along, x)[0].values.ravel()[finite])
        # The many legs of an oscillation are not told apart by their style.
        path = path if has_interaction(table) or len(path) <= MOST_LEGS else []
    middle_x, middle_y, low, high, good, runs = values
    series = Series(middle_x, middle_y, converged=good == 1, legs=path)
    if not (runs > 1).any():
        return series
    band = {"y_lowest": low, "y_highest": high, "runs": runs.astype(int)}
    written: dict[str, Any] = {
        name: np.where(runs > 1, column, None) for name, column in band.items()
    }
    return replace(series, low=low, high=high, columns=written | {"spread": spread})


def limit_of(grids: DataArray, points: Series, name: str, hue: int | None) -> Iterator[Series]:
    """Yield a curve continued to x = 0, and its limit there with the error."""
    if (count := np.unique(grids).size) < _GRIDS:
        raise ConfigError(
            f"{count} values of x on a curve do not fix a limit, a coefficient and an "
            f"exponent; vary the grid over at least {_GRIDS}",
            "extrapolate",
        )
    # An interrupted study may lack some of the grids.
    if np.unique(points.x).size < _GRIDS:
        return
    fit = extrapolate(points.x, points.y)
    x = np.linspace(0, float(points.x.max()), 200)
    y = np.append(fit.limit, fit(x[1:]))
    yield Series(x, y, look=Look(hue), role="reference", written=False)
    assert points.converged is not None
    yield Series(
        np.zeros(1),
        np.array([fit.limit]),
        name=f"{name}, extrapolated",
        look=Look(hue, None),
        low=np.array([fit.lowest]),
        high=np.array([fit.highest]),
        columns={"converged": bool(points.converged.all()), "exponent": fit.exponent},
    )
