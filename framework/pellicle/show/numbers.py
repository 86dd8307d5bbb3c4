"""The numbers of charts and tables as text: CSV in files, lines on a terminal."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from contextlib import nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from pellicle.components.charts import Chart, Column, Series, Table
from pellicle.files import atomic_write, for_document, storage_errors

if TYPE_CHECKING:
    from rich.console import Console


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


def text_of(table: Table, console: Console, *, si: bool = False) -> str:
    """Return the lines of a table; long heads and cells are folded to the width of the console."""
    from rich.table import Table as RichTable
    from rich.text import Text

    grid = RichTable(box=None, padding=(0, 2, 0, 0), pad_edge=False, header_style="")
    columns = []
    for column in table.columns:
        head, cells = column.read(si=si)
        side: Literal["right", "left"] = "right" if all(map(is_number, cells)) else "left"
        grid.add_column(Text(for_document(head)), justify=side, overflow="fold")
        columns.append(cells)
    for row in zip(*columns, strict=True):
        grid.add_row(*(Text(for_document(cell)) for cell in row))
    lines = "".join(segment.text for segment in console.render(grid)).splitlines()
    return "".join(f"{line.rstrip()}\n" for line in lines)


def is_number(text: str) -> bool:
    """Return whether a text is empty, a number, or a dash in place of one."""
    with suppress(ValueError):
        float(text.replace("∞", "inf").replace("–", "nan") or "0")
        return True
    return False
