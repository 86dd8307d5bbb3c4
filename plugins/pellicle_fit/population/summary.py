"""Median and quartiles of each parameter, for each group of curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from .rules import is_closed

ALL = "all"
"""Name of the line of all accepted curves."""
_DRAWN = ("reduced_modulus", "youngs_modulus", "tension", "work_of_adhesion")


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


def summary(rows: Sequence[Mapping[str, Any]]) -> list[Quartiles]:
    """Return a line for each parameter and group that has an accepted curve, then for all curves.

    Parameters that were fixed have none.  Where all intervals are open, quartiles are NaN.
    """
    groups = list(dict.fromkeys(row["group"] for row in rows))
    several = groups if len(groups) > 1 else []
    lines = []
    for name in _DRAWN:
        for group in (*several, None):
            members = [row for row in rows if group is None or row["group"] == group]
            whole = [row for row in members if row["accepted"] and name in row]
            whole = [row for row in whole if not row[name]["held"]]
            if not whole:
                continue
            values = [row[name]["value"] for row in whole if is_closed(row[name])]
            quartiles = np.quantile(values or np.nan, (0, 0.25, 0.5, 0.75, 1))
            lines.append(
                Quartiles(
                    label(group) if group is not None else ALL,
                    name,
                    whole[0][name]["unit"],
                    len(members),
                    len(whole),
                    len(whole) - len(values),
                    sum(row["outlier"] for row in whole),
                    *quartiles.tolist(),
                )
            )
    return lines


def label(group: str) -> str:
    """Return the name of a group in tables and figures."""
    return group or "no group"
