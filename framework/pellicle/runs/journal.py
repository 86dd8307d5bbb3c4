"""The result file of a run, complete after every load step, from which a run resumes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from pellicle.errors import StorageError
from pellicle.files import check_writable, storage_errors
from pellicle.results import storage
from pellicle.results.result import load


@dataclass(frozen=True)
class Journal:
    """The file ``<stem>.h5`` of one run; it pickles to workers."""

    stem: Path
    """Folder and file name of the run, without a suffix."""
    identity: str
    """The run's `Run.identity`: the result of another run is not replaced."""
    overwrite: bool = False
    """Whether to start over and replace any existing file."""

    @property
    def path(self) -> Path:
        """The file."""
        return self.stem.with_name(f"{self.stem.name}.h5")

    def finished(self) -> xr.Dataset | None:
        """Return the numbers of the steps in the file; None if it is not a file of this run."""
        with storage_errors(self.path):
            exists = self.path.exists()
        if self.overwrite or not exists:
            return None
        steps = storage.read(self.path, without=["x", "y"])
        return steps if steps.attrs.get("identity") == self.identity else None

    def resume(self) -> list[xr.Dataset]:
        """Return the steps that an earlier process finished, each a dataset of its own."""
        check_writable(self.path)
        if self.overwrite or not self.path.exists():
            return []
        try:
            if storage.attributes(self.path).get("identity") != self.identity:
                raise StorageError(f"{self.path} holds the result of another configuration")
            steps = load(self.path).dataset
        except StorageError as error:
            raise StorageError(f"{error}; {storage.REPLACING}") from None
        steps = steps[[name for name, column in steps.data_vars.items() if "step" in column.dims]]
        return [steps.isel(step=[index]) for index in range(steps.sizes["step"])]

    def append(self, step: xr.Dataset) -> None:
        """Append a step to the file; the first step replaces any old file."""
        if step["step"].item() == 1:
            storage.write(step, self.path)
        else:
            storage.append(step, self.path)

    def close(self) -> tuple[Path, ...]:
        """Merge all steps into one file, and return its path."""
        storage.close(self.path)
        return (self.path,)
