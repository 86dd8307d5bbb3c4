"""A study from configuration to table: plan, skip what is done, carry out the rest, collect."""

from __future__ import annotations

import sys
import tempfile
import time
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from pellicle import memory
from pellicle.checks import checked_threads, read_only_dataset
from pellicle.components import Output, Place, Say
from pellicle.components.calls import outcomes_of
from pellicle.config.run import Run
from pellicle.config.study import Study
from pellicle.errors import ConfigError, ConvergenceWarning, StorageError
from pellicle.files import check_writable
from pellicle.plugins import registry
from pellicle.results import storage
from pellicle.results.status import Status
from pellicle.runs.lock import locked
from pellicle.runs.progress import Saying, StudyProgress
from pellicle.runs.runner import execute, left_by, standard_outputs

from . import table

if TYPE_CHECKING:
    import xarray as xr
from .summary import coarse, failures

_TABLE_SHARE = 0.05


_WARNED = "warned"


@dataclass(frozen=True)
class RunTask:
    """A run that is to be carried out; it pickles to workers."""

    name: str
    """What is varied, with its values; the title of a run on its own."""
    run: Run
    place: Place
    index: tuple[int, ...] = ()
    """Where it is in the table."""
    outputs: tuple[Output, ...] = ()
    """What the run leaves besides its file."""

    @property
    def memory(self) -> int:
        """Memory that the run takes at its peak [bytes], estimated."""
        return int(min(memory.estimate(self.run.grid, self.steps, self.run.solver), sys.maxsize))

    @property
    def steps(self) -> int:
        """Load steps that the run has in all."""
        return len(self.run.loading.values)

    def done(self) -> xr.Dataset | None:
        """Return the numbers of the steps that its file holds; None if it has no such file.

        Raises
        ------
        StorageError
            There is a file, but it cannot be read or resumed.
        """
        path = self.place.file(".h5")
        if self.place.overwrite or not path.exists():
            return None
        scalars = storage.scalars(path)
        if scalars.attrs.get("identity") != self.place.identity:
            return None
        storage.require_consecutive(scalars, path)
        return scalars


class Carried(NamedTuple):
    """What came of a study."""

    table: xr.Dataset
    files: tuple[Path, ...]
    taken: int
    """How many runs were done before."""


def run_study(
    configuration: Study | Mapping[str, Any] | str | Path,
    directory: str | Path | None = None,
    *,
    progress: bool = True,
    fields: bool = False,
    overwrite: bool = False,
    threads: int | None = None,
) -> xr.Dataset:
    """Carry out a study, but for the runs that are done, and return its table.

    Parameters
    ----------
    configuration
        A `Study`, the path of a TOML file, or a mapping of the same form.
    directory
        Folder of the study: a file for each run in ``runs``, ``study.h5`` and ``study.csv``. What
        it holds of the same runs is not solved again. Without it nothing that is written stays.
    progress
        Show a bar on a terminal; without one, a line for each run.
    fields
        Have pressure, displacement, gap and contact in the table too; they are read from the
        files of the runs where they are used.
    overwrite
        Begin anew, in place of what the folder holds.
    threads
        Threads of each run's Fourier transforms, a whole number ≥ 1; as the executor says if None.

    Returns
    -------
    xarray.Dataset
        The numbers of each step over the varied parameters, which are dimensions, and ``step``;
        NaN where there is none. ``status`` says how a step ended, or why there is none; ``run``
        names the file of a run.

    Raises
    ------
    ConfigError, PluginError
        The study cannot be made; nothing was run.
    StorageError
        The folder cannot be used; what was computed before is kept.

    Warns
    -----
    ConvergenceWarning
        A step did not converge, or a run failed; ``status`` says which and why.
    """
    from .lazy_fields import add_fields

    threads = checked_threads(threads)
    study = Study.of(configuration)
    if fields:
        if directory is None:
            raise ConfigError("fields are read from files: give a directory", "fields")
        if any(key.partition(".")[0] == "grid" for key in study.coordinates()):
            raise ConfigError(
                "runs on different grids have no fields in common; open the files in runs/",
                "fields",
            )
    with tempfile.TemporaryDirectory() as temporary:
        made = carry_out(
            study,
            Path(directory or temporary),
            progress=progress,
            overwrite=overwrite,
            threads=threads,
        ).table
    if message := failures(made):
        warnings.warn(f"{message}; see status", ConvergenceWarning, stacklevel=2)
    return add_fields(made, Path(directory) / "runs") if fields and directory else made


def tasks(study: Study, directory: Path, *, overwrite: bool = False) -> list[RunTask]:
    """Return all runs of a study, done or not."""
    named = study.points[0].run.outputs or ()
    made = []
    for point in study.points:
        identity = point.run.identity
        configuration = point.run.to_json(as_given=True)
        place = Place(directory / "runs", identity[:16], configuration, identity, overwrite)
        made.append(RunTask(point.name, point.run, place, point.position, _by_run(named)))
    return made


def carry_out(
    study: Study,
    directory: Path,
    *,
    progress: bool = False,
    overwrite: bool = False,
    threads: int | None = None,
) -> Carried:
    """Carry out a study in a folder that no other process is at.

    What is interrupted leaves the table of all that was finished.
    """
    with locked(directory, "study"):
        return _carry_out(study, directory, progress, overwrite, threads)


def _carry_out(
    study: Study, directory: Path, progress: bool, overwrite: bool, threads: int | None
) -> Carried:
    import xarray as xr

    place = Place(directory, "study", study.to_json(as_given=True), overwrite=overwrite)
    outputs = [o for o in standard_outputs(study.points[0].run.outputs) if o.draws_studies]
    for output in outputs:
        output.open(place)
    check_writable(directory / "runs" / "run.h5")
    _require_table(directory / "study.h5", overwrite)
    rows = table.Table(study)
    every = tasks(study, directory, overwrite=overwrite)
    unfinished = [task for task in every if _collect(task, rows) < task.steps]
    taken = len(study.points) - len(unfinished)
    files = _Writer(directory)
    files.write(rows)
    left = {task.index: task for task in unfinished}
    doubts: dict[str, None] = {}
    work = partial(solve, threads=threads or study.executor.threads)
    try:
        with (
            StudyProgress(len(study.points), taken, progress) as bar,
            closing(outcomes_of(study.executor, work, unfinished, bar.report, xr.Dataset)) as ends,
        ):
            for task, outcome in ends:
                del left[task.index]
                if isinstance(outcome, Exception):
                    _collect(task, rows)
                    rows.fail(task.index, _one_line(outcome))
                else:
                    rows.put(task.index, outcome)
                    doubts |= dict.fromkeys(outcome.attrs.pop(_WARNED))
                # A full disk fails all runs to come: it is found out by writing at once.
                files.write(rows, at_once=isinstance(outcome, StorageError))
                bar.finished(task, *_verdict(outcome))
    finally:
        for task in left.values():
            _collect(task, rows)
        files.write(rows, at_once=True)
        made = rows.dataset()
        drawn = left_by(
            outputs,
            "study()",
            lambda output: output.study(place, read_only_dataset(made)),
            study.points[0].run.outputs,
        )
    for message in (*doubts, *(f"{message}; see status" for message in coarse(made))):
        warnings.warn(message, stacklevel=4)
    return Carried(made, (*files.paths, *drawn), taken)


def solve(task: RunTask, say: Say, threads: int | None) -> xr.Dataset:
    """Solve a run where a worker is, leave its file, and return its numbers.

    What it warned of is among their attributes, to be said once for all runs.
    """
    hdf5 = registry().make(Output, {"type": "hdf5"})
    bar = Saying(task.steps, say)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", UserWarning)
        outputs = [hdf5, *task.outputs]
        done = execute(task.run, task.place, outputs, bar, threads=threads, lock=False)
    warned = [str(each.message) for each in caught]
    return done.result.dataset.drop_dims(["x", "y"]).assign_attrs({_WARNED: warned})


class Planned(NamedTuple):
    """What is known of a run before it is carried out."""

    task: RunTask
    done: int
    """Steps that are there already."""
    problem: str
    """Why its file cannot be used, if so."""


def plan(of: Sequence[RunTask]) -> Iterator[Planned]:
    """Yield what is there already of each run."""
    for task in of:
        try:
            found = task.done()
        except StorageError as error:
            yield Planned(task, 0, str(error))
        else:
            yield Planned(task, 0 if found is None else found.sizes["step"], "")


def read(path: Path) -> tuple[xr.Dataset, Path]:
    """Return the table of a study by its folder or its ``study.h5``, and the folder.

    Raises
    ------
    StorageError
        There is none, or it cannot be read.
    """
    whole = path / "study.h5" if path.is_dir() else path
    dataset = storage.table(whole)
    if problem := table.damage(dataset):
        raise StorageError(f"{whole}: {problem}, so it is damaged; run the study again")
    return dataset, whole.parent


def is_table(path: Path) -> bool:
    """Whether a path is the folder of a study, or its table."""
    return path.name == "study.h5" or (path / "study.h5").is_file()


def _by_run(named: Sequence[Output]) -> tuple[Output, ...]:
    """Return the outputs that each run calls itself: its file is there in any case."""
    return tuple(o for o in named if not o.draws_studies and o.type_name != "hdf5")


def _collect(task: RunTask, rows: table.Table) -> int:
    """Put what the file of a run holds into the table; return how many steps that is."""
    try:
        found = task.done()
    except StorageError:
        # The run itself will say what to do about it.
        return 0
    if found is None:
        return 0
    rows.put(task.index, found)
    return found.sizes["step"]


def _require_table(path: Path, overwrite: bool) -> None:
    """Refuse to replace what is no table of a study."""
    if overwrite or not path.exists():
        return
    try:
        with storage.opened(path, "table"):
            pass
    except StorageError as error:
        raise StorageError(f"{error}; {storage.REPLACING}") from None


def _verdict(outcome: xr.Dataset | Exception) -> tuple[str, bool]:
    if isinstance(outcome, Exception):
        return Status.FAILED.value.format(reason=_one_line(outcome)), True
    if outcome["converged"].values.all():
        return "converged", False
    return "NOT CONVERGED", True


def _one_line(error: Exception) -> str:
    said = "; ".join(str(error).splitlines()) or "no reason given"
    ours = isinstance(error, (ConfigError, StorageError))
    return said if ours else f"{type(error).__name__}: {said}"


class _Writer:
    """Keeps the files of the table up to date, at a small share of the time."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._next = 0.0
        self.paths: tuple[Path, ...] = ()

    def write(self, rows: table.Table, *, at_once: bool = False) -> None:
        begun = time.monotonic()
        if begun < self._next and not at_once:
            return
        self.paths = table.write(rows.dataset(), self._directory)
        ended = time.monotonic()
        self._next = ended + (ended - begun) / _TABLE_SHARE
