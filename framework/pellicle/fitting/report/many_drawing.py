"""The picture of many fits: modulus and tension of each, with their intervals."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.report.plotting import axis_unit

from .pictures import Drawn

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

_BEYOND = 1.1
"""Where an open end is drawn, over the largest value."""
_NAMED = 20
"""Curves whose names have room below the axis."""
_SHARED = ("reduced_modulus", "tension")


def pictures(rows: list[dict[str, Any]]) -> list[Drawn]:
    """Return the pictures of what `fit_many` found: one, if any curve was fitted."""
    if not any(name in row for name in _SHARED for row in rows):
        return []
    said = "A bar is the interval: down to 0, or up to a triangle, where an end is open."
    return [Drawn(partial(_fill, rows), said)]


def estimates(rows: list[dict[str, Any]], name: str, axes: Axes) -> None:
    """Draw a parameter of each curve that was fitted, with its interval.

    An open end goes down to 0, or up to a triangle at the top.
    """
    there = [(place, row[name]) for place, row in enumerate(rows, 1) if name in row]
    values = np.array([said["value"] for _, said in there])
    scale, unit = axis_unit(values, there[0][1]["unit"])
    low = np.array([said["low"] or 0.0 for _, said in there])
    high = np.array([np.nan if said["high"] is None else said["high"] for _, said in there])
    opened = np.isnan(high)
    high[opened] = _BEYOND * max(values.max(), high[~opened].max(initial=0.0))
    places = np.array([place for place, _ in there])
    ends = np.array([values - low, high - values]) * scale
    axes.errorbar(places, values * scale, ends, fmt="o", color="C0", markersize=4, capsize=2)
    axes.plot(places[opened], high[opened] * scale, "^", color="C0", markersize=6)
    axes.set_ylabel(f"{name.replace('_', ' ')} [{unit}]")
    axes.set_ylim(bottom=0.0)
    axes.grid(alpha=0.3)


def _fill(rows: list[dict[str, Any]], figure: FigureBase) -> None:
    upper, lower = figure.subplots(2, 1, sharex=True)
    for name, axes in zip(_SHARED, (upper, lower), strict=True):
        estimates(rows, name, axes)
    if len(rows) <= _NAMED:
        names = [Path(row["curve"]).name for row in rows]
        lower.set_xticks(range(1, len(rows) + 1), names, rotation=45, ha="right", fontsize="small")
    else:
        lower.set_xlabel("curve")
