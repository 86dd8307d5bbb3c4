"""The web page of many fits: a row for each curve, the figure, and what they were told."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pellicle.fitting.table import FITTED
from pellicle.report.page import Cell, Notice, Section, Table

from . import many_drawing, sheet

_UNITS = {"reduced_modulus": "Pa", "tension": "N/m", "contact_point": "m"}


def save_report(rows: list[dict[str, Any]], path: Path, title: str) -> Path:
    """Write the page of what `carry_out` found, one file that loads nothing, and return its name.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    failed = [row for row in rows if row["status"] != FITTED]
    what = f"{len(rows) - len(failed)} of {len(rows)} curves were fitted."
    said = Notice(what, not failed, [f"{row['curve']}: {row['status']}" for row in failed])
    messages = [f"{row['curve']}: {each}" for row in rows for each in row.get("messages", ())]
    models = [row["model"] for row in rows if "model" in row]
    sections = [
        Section("Result", [said, _found(rows), *sheet.careful(messages)]),
        Section("Figures", sheet.pictures(many_drawing.pictures(rows))),
        Section("Inputs", [sheet.model(models)] if models else []),
    ]
    return sheet.save(path, title, "Fits", sections, {"curves": rows})


def _found(rows: list[dict[str, Any]]) -> Table:
    columns = [sheet.words("curve", [row["curve"] for row in rows])]
    for name, unit in _UNITS.items():
        if any(name in row for row in rows):
            said = [row.get(name) for row in rows]
            columns += sheet.estimates(name.replace("_", " "), said, unit)
    verdicts = [row["status"].partition(":")[0] for row in rows]
    status = [Cell(verdict, bad=verdict != FITTED) for verdict in verdicts]
    columns.append(sheet.words("status", status))
    return sheet.table("Each curve on its own, with its 95 % intervals.", columns)
