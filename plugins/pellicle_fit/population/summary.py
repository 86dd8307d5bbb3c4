"""Median and quartiles of each parameter, for each group of curves."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from .row import OVER_TIED, SHOWN, Row

ALL = "all"
"""Name of the line of all accepted curves."""
QUARTILES = "minimum", "lower_quartile", "median", "upper_quartile", "maximum"


def summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Return a line for each parameter and group that has an accepted curve, then for all curves.

    Of all ``curves`` of a group ``n`` are accepted. Those whose intervals are ``open``, or too wide
    to quote a value, change no quartile; where all are, quartiles are NaN. Parameters that
    were fixed have no line.
    """
    import pandas as pd

    fitted = [
        (name, row.group, e.unit, e.value if row.determines(name) else np.nan, row.outlier)
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
            values = part["value"]
            line = {"group": group, "parameter": name, "unit": part["unit"].iloc[0]}
            line |= {"curves": count, "n": len(part), "open": int(values.isna().sum())}
            quartiles = values.quantile([0, 0.25, 0.5, 0.75, 1]).tolist()
            line["outliers"] = int(part["outlier"].sum())
            lines.append(line | dict(zip(QUARTILES, quartiles, strict=True)))
    return lines


def label(group: str) -> str:
    """Return the name of a group in tables and figures."""
    return group or "no group"
