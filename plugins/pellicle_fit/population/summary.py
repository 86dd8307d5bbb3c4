"""Median and quartiles of each parameter, for each group of curves."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pellicle_fit.wording import OVER_TIED, SHOWN

from .row import Row

ALL = "all"
"""Name of the line of all accepted curves."""


class Quartiles(NamedTuple):
    """The distribution of one parameter in one group."""

    group: str
    parameter: str
    unit: str
    curves: int
    """Number of curves of the group, accepted or not."""
    n: int
    """Number of accepted curves."""
    open: int
    """How many of them have an open interval; their values, some of many, are left out."""
    outliers: int
    minimum: float
    lower_quartile: float
    median: float
    upper_quartile: float
    maximum: float


def summary(rows: Sequence[Row]) -> list[Quartiles]:
    """Return a line for each parameter and group that has an accepted curve, then for all curves.

    Parameters that were fixed have none.  Where all intervals are open, quartiles are NaN.
    """
    import pandas as pd

    fitted = [
        (name, row.group, e.unit, e.value if row.is_closed(name) else np.nan, row.outlier)
        for name in dict.fromkeys((*OVER_TIED, *SHOWN))
        for row in rows
        if row.accepted and (e := row.estimates.get(name)) is not None and not e.held
    ]
    frame = pd.DataFrame(fitted, columns=["parameter", "group", "unit", "value", "outlier"])
    curves, lines = Counter(row.group for row in rows), []
    for name, whole in frame.groupby("parameter", sort=False):
        groups = whole.groupby("group", sort=False) if len(curves) > 1 else ()
        parts = [(label(group), curves[group], part) for group, part in groups]
        for group, count, part in (*parts, (ALL, len(rows), whole)):
            values, unit = part["value"], part["unit"].iloc[0]
            counts = len(part), int(values.isna().sum()), int(part["outlier"].sum())
            quartiles = values.quantile([0, 0.25, 0.5, 0.75, 1]).tolist()
            lines.append(Quartiles(group, name, unit, count, *counts, *quartiles))
    return lines


def label(group: str) -> str:
    """Return the name of a group in tables and figures."""
    return group or "no group"
