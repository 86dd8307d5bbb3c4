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


def print_fit(fit: Fit, *, details: bool = False, si: bool = False) -> None:
    """Print numbers, verdict and next step, and in detail what they rest on."""
    from pellicle_fit.report import tables
    from pellicle_fit.words.story import told

    for line in told(fit, si=si):
        echo(line)
    if details:
        for table in (tables.estimates, tables.explanations, tables.curves):
            print_table(table(fit, si=si), si=si)
    print_warnings(fit, details=details)


def print_warnings(fit: Fit, *, details: bool = False) -> None:
    """Print the warnings of a fit and, in detail, the checks that fail and the notes."""
    from pellicle_fit.words.remarks import CHECKS

    if fit.answer.agreement.factor > 1:
        echo(f"warning: {fit.agreement}", err=True)
    for text in fit.warnings:
        # The verdict tells the check that fails, and the next step what to do.
        if details or len(fit.members) > 1 or not text.endswith(tuple(CHECKS.values())):
            echo(f"warning: {text}", err=True)
    for text in fit.notes if details else ():
        echo(f"note: {text}", err=True)


def print_fits(fits: ManyFits, *, quiet: bool, directory: Path | None, si: bool = False) -> None:
    """Print a line for each curve and for each group, and the notes on them.

    Of many curves, lines are left out if the table is in the folder.
    """
    from pellicle_fit.report import tables
    from pellicle_fit.words.population import advice_of_population, sentences_of_population

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
    if len({row.group for row in fits.rows if row.accepted}) > 1:
        print_table(tables.groups(fits.rows, si=si), si=si)
    for line in [*sentences_of_population(fits), *advice_of_population(fits.rows)]:
        echo(line)


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
