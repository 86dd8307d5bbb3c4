"""An output for pellicle in one method: the highest pressure of each load step."""

from pathlib import Path
from typing import Literal

from pellicle import Output


class Hottest(Output):
    """Text file with the highest pressure of each step, of a run or of all runs of a study."""

    type: Literal["hottest"] = "hottest"

    def write(self, runs, stem):
        """Write a line for each step; return the file."""
        path = Path(f"{stem}.txt")
        pressures = runs.column("max(pressure)").values.ravel()
        path.write_text("".join(f"{pressure!r}\n" for pressure in pressures.tolist()))
        return (path,)
