"""Print fits on the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from .printing import print_table

if TYPE_CHECKING:
    from pellicle.fitting.many import ManyFits
    from pellicle.fitting.result import FitResult

_UNITS = {"reduced_modulus": "Pa", "tension": "N/m", "thickness": "m", "contact_point": "m"}
"""Parameters that a line has, if a fit has them."""
_LINES = 50
"""Largest number of curves that are listed although a table is written."""


def print_fit(fit: FitResult) -> None:
    """Print the estimates of a fit, a line for each curve of a pool, and the fit in words."""
    from pellicle.fitting.result import interval_text

    rows = []
    for name, estimate in fit.estimates().items():
        ends = "fixed" if estimate.held else interval_text(estimate.low, estimate.high)
        value = f"{estimate.value:.4g}"
        rows.append({"": name, "value": value, "95 % interval": ends, "unit": estimate.unit})
    print_table(["", "value", "95 % interval", "unit"], rows)
    if curves := fit.curve_rows():
        print_table(list(curves[0]), curves)
    for sentence in fit.sentences:
        typer.echo(sentence)
    for warning in fit.warnings:
        typer.echo(f"warning: {warning}", err=True)
    for note in fit.notes:
        typer.echo(f"note: {note}", err=True)


def print_fits(fits: ManyFits, *, quiet: bool, directory: Path | None) -> None:
    """Print a line for each curve and for each group, and what to know of them.

    Of many curves, lines are left out if the table is in the folder.
    """
    from pellicle.units import readable

    for row in fits.rows:
        _, _, reason = row["status"].partition(": ")
        if reason:
            typer.echo(f"{row['curve']}: {reason}", err=True)
    for note in fits.notes:
        typer.echo(f"note: {note}", err=True)
    if quiet:
        return
    if directory is None or len(fits.rows) <= _LINES:
        names = [name for name in _UNITS if any(name in row for row in fits.rows)]
        lines = [_line(row, names) for row in fits.rows]
        print_table(list(lines[0]), lines)
    else:
        typer.echo(f"{len(fits.rows)} curves: see {directory / 'fits.csv'}")
    groups = []
    for part in fits.summary():
        numbers = part.lower_quartile, part.median, part.upper_quartile
        low, middle, high = (readable(value, part.unit, 4) for value in numbers)
        groups.append(
            {
                "group": part.group,
                "parameter": part.parameter,
                "accepted": f"{part.n} of {part.curves}",
                "outliers": str(part.outliers),
                "median": middle,
                "quartiles": f"{low} to {high}",
            }
        )
    if groups and len(fits.rows) > 1:
        print_table(list(groups[0]), groups)


def _line(row: Mapping[str, Any], names: Sequence[str]) -> dict[str, str]:
    """Return the line of one curve with some parameters; the table has its sentences."""
    from pellicle.fitting.result import interval_text

    line = {"curve": row["curve"]}
    for name in names:
        estimate = row.get(name)
        line[f"{name} [{_UNITS[name]}]"] = f"{estimate['value']:.4g}" if estimate else ""
        if name != "contact_point":
            interval = interval_text(estimate["low"], estimate["high"]) if estimate else ""
            fixed = estimate and estimate["held"]
            line[f"95 % of {name}"] = "" if fixed else interval
    codes = ", ".join(check["code"] for check in row.get("failed_checks", ()))
    notes = str(len(row.get("messages", ())))
    verdict = row["status"].partition(": ")[0]
    if verdict == "fitted" and not row["accepted"]:
        verdict = "rejected"
    return line | {"failed checks": codes, "notes": notes, "status": verdict}
