"""Print fits on the terminal."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from pellicle.cli import NOT_CONVERGED, echo, print_json, print_table
from pellicle.errors import first_of
from pellicle.files import is_file

if TYPE_CHECKING:
    from pellicle_fit.population.fits import ManyFits
    from pellicle_fit.result import Fit

_LINES = 50
"""Largest number of curves that are listed although a table is written."""


def print_fit(fit: Fit, *, si: bool = False) -> None:
    """Print what a fit says in words, its estimates, and a line for each curve of several."""
    from pellicle_fit.report import tables
    from pellicle_fit.report.sentences import sentence_of_fit

    echo(sentence_of_fit(fit, si=si))
    print_table(tables.estimates(fit, si=si), si=si)
    if len(fit.members) > 1:
        print_table(tables.curves(fit, si=si), si=si)
    if fit.config.compare:
        print_table(tables.explanations(fit, si=si), si=si)
    for sentence in fit.sentences:
        echo(sentence)
    print_notes(fit)


def print_notes(fit: Fit) -> None:
    """Print the warnings and notes of a fit."""
    for kind, texts in (("warning", fit.warnings), ("note", fit.notes)):
        for text in texts:
            echo(f"{kind}: {text}", err=True)


def print_fits(fits: ManyFits, *, quiet: bool, directory: Path | None, si: bool = False) -> None:
    """Print a line for each curve and for each group, and the notes on them.

    Of many curves, lines are left out if the table is in the folder.
    """
    from pellicle_fit.report import tables

    reasons: dict[str, list[str]] = {}
    for row in fits.rows:
        if reason := row.status.partition(": ")[2]:
            reasons.setdefault(reason, []).append(row.name)
    for reason, curves in reasons.items():
        echo(f"{first_of(curves)}: {reason}", err=True)
    for note in fits.notes:
        echo(f"note: {note}", err=True)
    if quiet:
        return
    if directory is None or len(fits.rows) <= _LINES:
        print_table(tables.rows(fits.rows, si=si), si=si)
    else:
        echo(f"{len(fits.rows)} curves: see {directory / 'fits.csv'}")
    if len(fits.rows) > 1 and any(row.accepted for row in fits.rows):
        print_table(tables.groups(fits.rows, si=si), si=si)


def show_fits(directory: Path, si: bool, json: bool) -> bool:
    """Print the tables that ``pellicle fit`` left in a folder; return False if it left none.

    Raises
    ------
    typer.Exit
        Some curves could not be fitted.
    """
    if not is_file(directory / "fits.json"):
        return False
    from pellicle_fit.population.fits import ManyFits
    from pellicle_fit.population.row import Row
    from pellicle_fit.record import content_of

    content = content_of(directory / "fits.json")
    rows = [Row.from_dict(row) for row in content.get("curves", [])]
    fits = ManyFits(rows, notes=content.get("notes", []))
    if json:
        print_json(content)
    else:
        print_fits(fits, quiet=False, directory=directory, si=si)
    if fits.failed:
        raise typer.Exit(NOT_CONVERGED)
    return True
