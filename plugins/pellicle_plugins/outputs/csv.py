"""The numbers of each step as a table."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Literal

from pellicle.components import Output, Runs
from pellicle.files import storage_errors
from pellicle.results import header
from pellicle.variables import CAVEATS

if TYPE_CHECKING:
    import xarray as xr


class Csv(Output):
    """Table with one row for each step; units in the header."""

    type: Literal["csv"] = "csv"
    examples = ({},)
    scope: ClassVar[Literal["run"]] = "run"
    shares_stem: ClassVar[bool] = True

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffix of the table."""
        return (".csv",)

    def step(self, record: xr.Dataset, stem: Path) -> None:
        """Write the row of the step, the first with a header."""
        path = Path(f"{stem}.csv")
        row = {
            header(str(name), variable): variable.item()
            for name, variable in record.data_vars.items()
            if variable.dims == ("step",) and name != CAVEATS
        }
        number = record["step"].item()
        mode = "a" if number > 1 else "w"
        with storage_errors(path), path.open(mode, newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            if number == 1:
                writer.writerow(["step", *row])
            writer.writerow([number, *row.values()])

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Return the file, which is complete."""
        return (Path(f"{stem}.csv"),)
