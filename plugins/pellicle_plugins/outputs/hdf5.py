"""The result file as an entry of ``[[outputs]]``."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar, Literal

from pellicle.components import Output, Runs


class Hdf5(Output):
    """Result file, HDF5 (NetCDF-4) with all fields; it is written in any case."""

    type: Literal["hdf5"] = "hdf5"
    scope: ClassVar[Literal["run"]] = "run"

    @property
    def suffixes(self) -> tuple[str, ...]:
        """No files: the framework writes the result."""
        return ()

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write nothing."""
        return ()
