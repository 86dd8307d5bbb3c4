"""Print fits on the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer

from .printing import print_table

if TYPE_CHECKING:
    from pellicle.fitting.result import FitResult


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


def print_fits(rows: list[dict[str, Any]]) -> None:
    """Print a line for each curve; the table in the folder has their sentences."""
    from pellicle.fitting.result import interval_text

    lines = []
    for row in rows:
        line = {"curve": row["curve"]}
        for name, unit in (("reduced_modulus", "Pa"), ("tension", "N/m"), ("contact_point", "m")):
            estimate = row.get(name)
            line[f"{name} [{unit}]"] = f"{estimate['value']:.4g}" if estimate else ""
            if name != "contact_point":
                interval = interval_text(estimate["low"], estimate["high"]) if estimate else ""
                fixed = estimate and estimate["held"]
                line[f"95 % of {name}"] = "" if fixed else interval
        verdict, _, reason = row["status"].partition(": ")
        codes = ", ".join(check["code"] for check in row.get("failed_checks", ()))
        notes = str(len(row.get("messages", ())))
        lines.append(line | {"failed checks": codes, "notes": notes, "status": verdict})
        if reason:
            typer.echo(f"{row['curve']}: {reason}", err=True)
    print_table(list(lines[0]), lines)
