"""Fits of one curve, of a pool and of many as ``pellicle fit`` left them, shown and drawn again."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from json import loads
from pathlib import Path

import h5py
import typer
import xarray as xr

from pellicle import results
from pellicle.cli import NOT_CONVERGED, echo, print_json
from pellicle.errors import StorageError

from .config import FitConfig
from .population.fits import ManyFits
from .population.images import force_maps
from .population.row import Row
from .print_fits import print_fit, print_fits
from .problem import problem
from .record import Record
from .report.figures import save_figure
from .report.population import save_population
from .result import Fit
from .sealed_json import read_sealed


def file_display(file: Path) -> StoredFit | StoredFits:
    """Return what shows a file that ``pellicle fit`` wrote of a fit or of many."""
    with h5py.File(file) as content:
        attributes = dict(content.attrs)
    return StoredFit(file.stem, attributes["fit"]) if "fit" in attributes else StoredFits(file)


class StoredFit:
    """The fit of one curve, or of several of one solid: a file with its JSON."""

    @staticmethod
    def write(fit: Fit, path: Path) -> Path:
        """Write the file of a fit, and return its path."""
        record = {"configuration": fit.config.to_json(), "versions": str(fit.data["versions"])}
        results.write(xr.Dataset(attrs={**record, "command": "fit", "fit": fit.to_json()}), path)
        return path

    def __init__(self, name: str, fit: str) -> None:
        self.name, self.fit = name, Record(loads(fit))

    def show(self, *, si: bool, json: bool) -> None:
        """Print what ``pellicle fit`` printed."""
        if json:
            print_json(self.fit.data)
        else:
            print_fit(self.fit, quiet=False, details=False, si=si)

    def plot(self, directory: Path, formats: Sequence[str]) -> Iterable[Path]:
        """Fit the curves again, whose files must not have changed, and write the figure."""
        config = FitConfig(**self.fit.data["configuration"])
        again = problem(config, [*config.sources()]).fit()
        for curve, was in zip(again.curves, self.fit.curves, strict=True):
            if curve["data"]["sha256"] != was["data"]["sha256"]:
                raise StorageError(f"{was['name']}: has changed since it was fitted; fit it again")
        return save_figure(again, directory / self.name, formats)


class StoredFits:
    """The fits beside a table ``fits.h5``, which ``fits.json`` holds with all that is shown."""

    def __init__(self, table: Path) -> None:
        self.folder = table.parent
        self.content = read_sealed(table.with_suffix(".json"), Row.of_dict)
        rows = self.content.pop("curves")
        self.fits = ManyFits(rows, notes=self.content["notes"], maps=force_maps(rows)[0])

    def show(self, *, si: bool, json: bool) -> None:
        """Print what ``pellicle fit`` printed; exit code 1 if some curves could not be fitted."""
        if json:
            print_json(self.fits.to_dict() | self.content)
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
