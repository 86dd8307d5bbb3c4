"""All fields and numbers in one HDF5 file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from pellicle import hookimpl
from pellicle.components import Output, Place
from pellicle.errors import StorageError
from pellicle.results import storage
from pellicle.results.result import Result, load

if TYPE_CHECKING:
    import xarray as xr


class Hdf5(Output):
    """HDF5 (NetCDF-4) file with all steps, whole after each of them."""

    type: Literal["hdf5"] = "hdf5"

    def endings(self) -> tuple[str, ...]:
        """Return that of the file."""
        return (".h5",)

    def open(self, place: Place) -> None:
        """Refuse to replace the result of another configuration."""
        super().open(place)
        path = place.file(".h5")
        if place.overwrite or not path.exists():
            return
        try:
            held = storage.attributes(path)
        except StorageError as error:
            raise StorageError(f"{error}; {storage.REPLACING}") from None
        if held.get("identity") != place.identity:
            raise StorageError(
                f"{path} holds the result of another configuration; {storage.REPLACING}"
            )

    def resume(self, place: Place) -> xr.Dataset | None:
        """Return the steps in the file; refuse one that something has damaged."""
        path = place.file(".h5")
        if place.overwrite or not path.exists():
            return None
        try:
            steps = load(path).dataset
        except StorageError as error:
            raise StorageError(f"{error}; {storage.REPLACING}") from None
        storage.require_consecutive(steps, path)
        return steps

    def step(self, place: Place, step: xr.Dataset) -> None:
        """Write the step behind the ones before it."""
        path = place.file(".h5")
        if step["step"].item() == 1:
            storage.write(step, path)
        else:
            storage.append(step, path)

    def close(self, place: Place, result: Result) -> tuple[Path, ...]:
        """Make it one file."""
        path = place.file(".h5")
        storage.close(path)
        return (path,)


@hookimpl
def register_outputs(register: Callable[[type[Output]], None]) -> None:
    """Register the HDF5 file."""
    register(Hdf5)
