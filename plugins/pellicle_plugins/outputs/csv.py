"""The numbers of each step as a table."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar, Literal

from pellicle import show
from pellicle.arrays import Dataset
from pellicle.components import Output, Runs
from pellicle.variables import CAVEATS


class Csv(Output):
    """Table with one row for each step; units in the header."""

    type: Literal["csv"] = "csv"
    examples = ({},)
    scope: ClassVar[Literal["run"]] = "run"
    shares_stem: ClassVar[bool] = True
    suffixes: ClassVar[tuple[str, ...]] = (".csv",)

    def step(self, record: Dataset, stem: Path) -> None:
        """Write the row of the step, the first with a header."""
        numbers = show.tables.numbers(record.drop_vars(CAVEATS))
        show.write_csv(numbers, Path(f"{stem}.csv"), append=record["step"].item() > 1)

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Return the file, which is complete."""
        return (Path(f"{stem}.csv"),)
