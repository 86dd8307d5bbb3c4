"""Print fits on the terminal."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from pellicle.cli import NOT_CONVERGED, echo, print_json, print_table
from pellicle.errors import first_of
from pellicle.files import is_file

if TYPE_CHECKING:
    from pellicle.components import Table
    from pellicle.units import Scale
    from pellicle_fit.many import ManyFits
    from pellicle_fit.result import FitResult

_UNITS = {
    "reduced_modulus": "Pa",
    "tension": "N/m",
    "work_of_adhesion": "J/m**2",
    "thickness": "m",
    "contact_point": "m",
}
"""Parameters that a line has, if a fit has them."""
_LINES = 50
"""Largest number of curves that are listed although a table is written."""


def print_fit(fit: FitResult, *, si: bool = False) -> None:
    """Print the estimates of a fit, a line for each curve of a pool, and the fit in words."""
    from pellicle.components import Table
    from pellicle_fit.report.sentences import sentence_of_fit
    from pellicle_fit.wording import interval_text, scale

    if fit.chosen is not None or fit.range_of_models():
        echo(sentence_of_fit(fit, si=si))
    if fit.chosen is not None:
        echo("An elastic solid under tension instead:")
    rows = []
    for name, estimate in fit.estimates().items():
        unit = scale(estimate, si=si)
        ends = "fixed" if estimate.held else interval_text(estimate.low, estimate.high, unit)
        rows.append((_words(name), unit.number(estimate.value), ends, unit.unit))
    heads = ("parameter", "value", "95 % interval", "unit")
    print_table(Table.of_rows(heads, rows))
    if curves := fit.curve_rows(si=si):
        print_table(Table.of_rows([*curves[0]], [[*row.values()] for row in curves]))
    if fit.rivals is not None and fit.config is not None and fit.config.compare:
        models = fit.rivals.rows(si=si)
        print_table(Table.of_rows([*models[0]], [[*row.values()] for row in models]))
    for sentence in fit.sentences:
        echo(sentence)
    print_notes(fit)


def print_notes(fit: FitResult) -> None:
    """Print the warnings and notes of a fit."""
    for warning in fit.warnings:
        echo(f"warning: {warning}", err=True)
    for note in fit.notes:
        echo(f"note: {note}", err=True)


def print_fits(fits: ManyFits, *, quiet: bool, directory: Path | None, si: bool = False) -> None:
    """Print a line for each curve and for each group, and the notes on them.

    Of many curves, lines are left out if the table is in the folder.
    """
    _print_failures(fits.rows)
    for note in fits.notes:
        echo(f"note: {note}", err=True)
    if quiet:
        return
    if directory is None or len(fits.rows) <= _LINES:
        print_table(_curves(fits.rows, si))
    else:
        echo(f"{len(fits.rows)} curves: see {directory / 'fits.csv'}")
    if len(fits.rows) > 1:
        print_table(_groups(fits, si))


def show_fits(directory: Path, si: bool, json: bool) -> bool:
    """Print the tables that ``pellicle fit`` left in a folder; return False if it left none.

    Raises
    ------
    typer.Exit
        Some curves could not be fitted.
    """
    if not is_file(directory / "fits.json"):
        return False
    from pellicle_fit.many import ManyFits
    from pellicle_fit.record import content_of

    content = content_of(directory / "fits.json")
    fits = ManyFits(content.get("curves", []), notes=content.get("notes", []))
    if json:
        print_json(content)
    else:
        print_fits(fits, quiet=False, directory=directory, si=si)
    if fits.failed:
        raise typer.Exit(NOT_CONVERGED)
    return True


def _curves(rows: list[dict[str, Any]], si: bool) -> Table:
    """Return a row for each curve; the table in the folder has their sentences."""
    from pellicle.components import Column, Table
    from pellicle_fit.wording import column_scale

    columns = [Column("curve", [str(row["curve"]) for row in rows])]
    if any(row.get("elastic") for row in rows):
        columns.append(Column("model", [row.get("chosen", {}).get("model", "") for row in rows]))
    for name, unit in _UNITS.items():
        estimates = [row.get(name) for row in rows]
        if not any(name in row for row in rows):
            continue
        scale = column_scale([e["value"] for e in estimates if e], unit, si=si)
        values = [scale.number(e["value"]) if e else "" for e in estimates]
        columns.append(Column(f"{_words(name)} [{scale.unit}]", values))
        if name != "contact_point":
            ends = [_interval_of(estimate, scale) for estimate in estimates]
            columns.append(Column(f"95 % of {_words(name)}", ends))
    return Table(
        [
            *columns,
            Column("failed checks", [_failed_checks(row) for row in rows]),
            Column("notes", [str(len(row.get("messages", ()))) for row in rows]),
            Column("status", list(map(_verdict, rows))),
        ]
    )


def _verdict(row: Mapping[str, Any]) -> str:
    verdict = str(row["status"]).partition(": ")[0]
    return "rejected" if verdict == "fitted" and not row["accepted"] else verdict


def _groups(fits: ManyFits, si: bool) -> Table:
    """Return a row for each parameter of each group of curves; no columns without any."""
    from pellicle.components import Column, Table
    from pellicle_fit.wording import group_scales

    parts, quartiles = fits.summary(), []
    scales = group_scales(parts, si=si)
    for part in parts:
        scale = scales[part.parameter]
        numbers = part.lower_quartile, part.median, part.upper_quartile
        low, middle, high = map(scale.number, numbers)
        quartiles.append((middle, f"{low} to {high}"))
    names = [f"{_words(part.parameter)} [{scales[part.parameter].unit}]" for part in parts]
    columns = [
        Column("group", [part.group for part in parts]),
        Column("parameter", names),
        Column("accepted", [f"{part.n} of {part.curves}" for part in parts]),
        Column("open", [str(part.open) for part in parts]),
        Column("outliers", [str(part.outliers) for part in parts]),
        Column("median", [median for median, _ in quartiles]),
        Column("quartiles", [ends for _, ends in quartiles]),
    ]
    return Table(columns if parts else [])


def _print_failures(rows: list[dict[str, Any]]) -> None:
    """Print why curves could not be fitted; curves of one reason on one line."""
    reasons: dict[str, list[str]] = {}
    for row in rows:
        if reason := str(row["status"]).partition(": ")[2]:
            reasons.setdefault(reason, []).append(str(row["curve"]))
    for reason, curves in reasons.items():
        echo(f"{first_of(curves)}: {reason}", err=True)


def _failed_checks(row: Mapping[str, Any]) -> str:
    return ", ".join(check["code"] for check in row.get("failed_checks", ()))


def _interval_of(estimate: Mapping[str, Any] | None, scale: Scale) -> str:
    if not estimate or estimate["held"]:
        return ""
    from pellicle_fit.wording import interval_text

    return interval_text(estimate["low"], estimate["high"], scale)


def _words(name: str) -> str:
    from pellicle_fit.wording import words

    return words(name)
