"""The contract of outputs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import (
    TYPE_CHECKING,
    ClassVar,
)

from pellicle.files import check_writable
from pellicle.results.result import Result

if TYPE_CHECKING:
    import xarray as xr
from .base import Component


@dataclass(frozen=True)
class Place:
    """Where the outputs of a run or of a study go."""

    directory: Path
    """Folder; made when something is written."""
    name: str
    """Stem of the file names."""
    configuration: str
    """The run or the study, as its `to_json` says it, with paths as they were given."""
    identity: str = ""
    """The run's `Run.identity`: what is there of another run is not to be touched."""
    overwrite: bool = False
    """Whether to begin anew, in place of whatever is there."""

    def file(self, ending: str) -> Path:
        """Return ``directory/name<ending>``."""
        return self.directory / f"{self.name}{ending}"


class Output(Component):
    """Leaves the result of a run or of a study somewhere.

    A run calls `open` once, `step` after each load step, and `close` once, also after an
    interruption, with the steps done so far. Steps that an output has from an earlier process, as
    `resume` says, are not solved again; `step` of the other outputs gets them all the same.

    In a study, an output that has a `study` of its own is called by the study alone; any other is
    called by each run. `endings` says what files it leaves.
    """

    family: ClassVar[str] = "output"

    @property
    def draws_studies(self) -> bool:
        """Whether a study calls it, once; any other is called by each run of the study."""
        return type(self).study is not Output.study

    def endings(self) -> tuple[str, ...]:
        """Return what `Place.file` is given for the files that it leaves, of a run or of a study.

        ``*`` stands for anything, as the number of a step. Outputs that would write the same file
        are refused. Here ``-type*``, or ``-name*`` if there is a field ``name`` that says one.
        """
        return (f"-{getattr(self, 'name', '') or self.type_name}*",)

    def open(self, place: Place) -> None:
        """Prepare; raise StorageError if it is plain that nothing can be written.

        Here the folder of its first file is tried.
        """
        for ending in self.endings()[:1]:
            check_writable(place.file(ending))

    def resume(self, place: Place) -> xr.Dataset | None:
        """Return the steps that an earlier process finished of the same run, if there are any."""
        return None

    def step(self, place: Place, step: xr.Dataset) -> None:
        """Take one finished step: a dataset with dimension step of length 1."""

    def close(self, place: Place, result: Result) -> tuple[Path, ...]:
        """Finish and return the files left behind."""
        return ()

    def study(self, place: Place, table: xr.Dataset) -> tuple[Path, ...]:
        """Leave what a study shows, made of its table, and return the files.

        ``table`` is what `pellicle.run_study` returns: numbers over the varied axes and ``step``;
        NaN, and a message in ``status``, where a run has not been done. It is called at the end,
        also of a study that was interrupted.
        """
        return ()
