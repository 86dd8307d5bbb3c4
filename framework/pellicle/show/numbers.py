"""The numbers of charts and tables as CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np

from pellicle.components.charts import Chart, Column, Series, Table
from pellicle.files import atomic_write, storage_errors


def write_csv(table: Table, path: Path, *, append: bool = False) -> Path:
    """Write a table in SI, or append its rows to those of a file, and return the file."""
    mode = "a" if append else "w"
    with (
        nullcontext(path) if append else atomic_write(path) as part,
        storage_errors(path),
        part.open(mode, newline="", encoding="utf-8") as file,
    ):
        writer = csv.writer(file)
        if not append:
            writer.writerow([column.head for column in table.columns])
        writer.writerows(zip(*(column.values for column in table.columns), strict=True))
    return path


def table_of(chart: Chart) -> Table:
    """Return the numbers that a chart draws, in SI; what is published in the units of its axes."""
    rows = [row for series in chart.series if series.written for row in _rows(chart, series)]
    heads = dict.fromkeys(head for row in rows for head in row)
    first = dict.fromkeys(("curve", "series", chart.x.head, *(axis.head for axis in chart.y)))
    return Table([Column(head, [row.get(head) for row in rows]) for head in first | heads])


def _rows(chart: Chart, series: Series) -> Iterator[dict[str, object]]:
    # A turn belongs to the leg that reaches it.
    directions = {
        step: leg.direction
        for leg in reversed(series.legs)
        for step in range(leg.steps.start, leg.steps.stop)
    }
    columns: dict[str, Any] = {chart.x.head: series.x, chart.y[series.panel].head: series.y}
    if series.low is not None and series.high is not None:
        columns |= {"y_lowest": series.low, "y_highest": series.high}
    columns |= series.columns
    for index in range(series.x.size):
        row: dict[str, object] = {"curve": series.key, "series": series.name}
        row |= {h: v[index] if isinstance(v, np.ndarray) else v for h, v in columns.items()}
        if index in directions:
            row["direction"] = directions[index]
        if series.converged is not None:
            row["converged"] = bool(series.converged[index])
        yield row
