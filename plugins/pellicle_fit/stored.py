"""Fits of many curves as ``pellicle fit`` left them in a folder, to be shown and drawn again."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import typer

from pellicle.cli import NOT_CONVERGED, echo, print_json

from .population.fits import ManyFits
from .population.images import force_maps
from .population.row import Row
from .print_fits import print_fits
from .report.population import save_population
from .sealed import read_sealed


class StoredFits:
    """The fits beside a table ``fits.h5``, which ``fits.json`` holds with all that is shown."""

    def __init__(self, table: Path) -> None:
        self.folder, self.whole = table.parent, read_sealed(table.with_suffix(".json"))
        rows = [Row.of_dict(curve) for curve in self.whole["curves"]]
        self.fits = ManyFits(rows, notes=self.whole["notes"], maps=force_maps(rows)[0])

    def show(self, *, si: bool, json: bool) -> None:
        """Print what ``pellicle fit`` printed; exit code 1 if some curves could not be fitted."""
        if json:
            print_json(self.whole)
        else:
            print_fits(self.fits, quiet=False, directory=self.folder, si=si)
        exit_by_fits(self.fits)

    def plot(self, directory: Path, formats: Sequence[str]) -> Iterable[Path]:
        """Write contact sheet, distributions and images of maps, and return their paths."""
        return save_population(self.fits, directory, formats)


def exit_by_fits(fits: ManyFits) -> None:
    """Say how many curves could not be fitted, and exit with 1 if there are any."""
    if failed := sum(not row.is_fitted for row in fits.rows):
        echo(f"{failed} of {len(fits.rows)} curves could not be fitted", err=True)
        raise typer.Exit(NOT_CONVERGED)
