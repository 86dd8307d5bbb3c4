"""Print fits on the terminal."""

from __future__ import annotations

from pathlib import Path

from pellicle.cli import echo, print_table

from .population.fits import ManyFits
from .record import Record
from .report import tables
from .words.population import advice_of_population, by_text, sentences_of_population
from .words.story import story_lines

_LINES = 50
"""Largest number of curves that are listed although a table is written."""


def print_fit(fit: Record, *, quiet: bool, details: bool, si: bool) -> None:
    """Print numbers, verdict and next step, then warnings; in detail what they rest on."""
    for line in () if quiet else story_lines(fit, si=si):
        echo(line)
    if fit.sines and not quiet:
        print_table(tables.sines(fit, si=si), si=si)
    if details and not quiet:
        for table in (tables.estimates, tables.explanations, tables.curves):
            print_table(table(fit, si=si), si=si)
        print_table(tables.correlations(fit), si=si)
    if fit.data["widening"] > 1:
        echo(f"warning: {fit.agreement}", err=True)
    all_checks = details or quiet or len(fit.curves) > 1
    # The verdict tells the check that fails, and the next step what to do.
    for text in fit.warnings if all_checks else fit.warnings_beside_checks:
        echo(f"warning: {text}", err=True)
    for text in fit.notes if details or quiet else ():
        echo(f"note: {text}", err=True)


def print_fits(fits: ManyFits, *, quiet: bool, directory: Path | None, si: bool) -> None:
    """Print a line for each curve, unless a folder has many, and the medians, and notes."""
    for line in by_text([(row.failure, row.name) for row in fits.rows if row.failure]):
        echo(line, err=True)
    for note in fits.notes:
        echo(f"note: {note}", err=True)
    if quiet:
        return
    if directory is None or len(fits.rows) <= _LINES:
        print_table(tables.rows(fits.rows, si=si), si=si)
    else:
        echo(f"{len(fits.rows)} curves: see {directory / 'fits.csv'}")
    print_table(tables.groups(fits.rows, si=si), si=si)
    for line in [*sentences_of_population(fits.rows), *advice_of_population(fits.rows)]:
        echo(line)
