"""Execute the unfinished runs of a study and collect the numbers of all runs in its table."""

from __future__ import annotations

import json
import sys
import tempfile
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import chain
from multiprocessing import parent_process
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from pellicle import memory
from pellicle.batch import BatchProgress, locked, mapped
from pellicle.checks import checked_threads, read_only_dataset
from pellicle.components import Executor, Output, Runs, Say
from pellicle.config.run import Run
from pellicle.config.study import DEFAULT_EXECUTOR, Study
from pellicle.errors import ConfigError, ConvergenceWarning, PluginError, StorageError
from pellicle.files import check_writable, is_file, is_folder
from pellicle.plugins import registry
from pellicle.results import storage
from pellicle.results.dimensions import with_paths, with_python_names
from pellicle.results.status import Status
from pellicle.results.variables import BEYOND_THEORY
from pellicle.runs import runner
from pellicle.runs.journal import Journal
from pellicle.runs.progress import ProgressReporter

from . import table
from .planned import check_outputs
from .summary import caveats, failures, progress_of, run_names

if TYPE_CHECKING:
    import xarray as xr

_TABLE_SHARE = 0.05
_LONG = 10.0
"""Time [s] of the runs that are left, one after the other, from which processes share them."""
_WARNINGS = "warnings"
_recording = threading.Lock()


@dataclass(frozen=True)
class RunTask:
    """A run of a study, finished or not; it can be pickled to workers."""

    name: str
    """The varied parameters with their values; the title of a single run."""
    run: Run
    journal: Journal
    index: tuple[int, ...] = ()
    """Its index in the table."""
    outputs: tuple[Output, ...] = ()
    """The outputs of each run, besides its result file."""

    @property
    def memory(self) -> int:
        """Estimated peak memory of the run [bytes]."""
        return int(min(runner.memory_of(self.run), sys.maxsize))

    @property
    def steps(self) -> int:
        """Number of load steps of the whole run."""
        return len(self.run.loading.values)


class StudyResult(NamedTuple):
    """The outcome of a study."""

    table: xr.Dataset
    files: tuple[Path, ...]
    resumed: int
    """Number of runs that had been finished before."""


def run_study(
    configuration: Study | Mapping[str, Any] | str | Path,
    directory: str | Path | None = None,
    *,
    progress: bool = True,
    fields: bool = False,
    overwrite: bool = False,
    threads: int | None = None,
) -> xr.Dataset:
    """Execute the runs of a study that are not finished, and return its table.

    Parameters
    ----------
    configuration
        A `Study`, the path of a TOML file, or a mapping of the same form.
    directory
        Folder of the study: a file for each run in ``runs``, ``study.h5`` and ``study.csv``. Steps
        of the same runs in these files are not solved again. Without a folder no file is kept.
    progress
        Show a bar on a terminal or in a notebook; elsewhere, a line for each run.
    fields
        Add pressure, displacement, gap and contact to the table; they are read from the files of
        the runs when they are used.
    overwrite
        Start over and replace the files in the folder.
    threads
        Threads of each run, a whole number ≥ 1; those of the executor if None.

    Returns
    -------
    xarray.Dataset
        The numbers of each step over the varied parameters, which are dimensions, and ``step``;
        NaN where a step is missing. A dimension is the path of its parameter with underscores, so
        that ``table.sel(kernel_tension=0.03)`` works. ``status`` states how a step ended, or why it
        is missing; ``run`` names the file of a run.

    Raises
    ------
    ConfigError, PluginError
        The configuration is not a valid study; nothing was solved.
    StorageError
        The folder cannot be used; finished steps are kept.

    Warns
    -----
    ConvergenceWarning
        A step did not converge, or a run failed; see ``status``.
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
        rows = execute(
            study,
            Path(directory or temporary),
            progress=progress,
            overwrite=overwrite,
            threads=threads,
        ).table
    if message := failures(rows):
        warnings.warn(f"{message}; see status", ConvergenceWarning, stacklevel=2)
    if fields and directory:
        rows = add_fields(rows, Path(directory) / "runs")
    return with_python_names(rows)


def tasks(study: Study, directory: Path, *, overwrite: bool = False) -> list[RunTask]:
    """Return all runs of a study, finished or not.

    Raises
    ------
    ConfigError
        The settings of an output do not fit the study.
    """
    check_outputs(study)
    outputs = tuple(o for o in study.points[0].run.outputs or () if o.scope == "run")
    names = run_names(table.StudyTable(study).dataset())
    return [
        RunTask(
            name,
            point.run,
            Journal(directory / "runs" / identity[:16], identity, overwrite),
            point.position,
            outputs,
        )
        for name, point in zip(names, study.points, strict=True)
        for identity in (point.run.identity,)
    ]


def execute(
    study: Study,
    directory: Path,
    *,
    progress: bool = False,
    overwrite: bool = False,
    threads: int | None = None,
) -> StudyResult:
    """Solve the runs of a study that are not finished, in a folder that no other process uses.

    After an interruption the table and the outputs show the finished steps.
    """
    with locked(directory, "study"):
        return _execute(study, directory, progress, overwrite, threads)


def _execute(
    study: Study, directory: Path, progress: bool, overwrite: bool, threads: int | None
) -> StudyResult:
    first = study.points[0].run
    outputs = [o for o in runner.standard_outputs(first.outputs) if o.scope != "run"]
    check_writable(directory / "study.h5")
    check_writable(directory / "runs" / "run.h5")
    _require_table(directory / "study.h5", overwrite)
    rows = table.StudyTable(study)
    if not overwrite:
        rows.recall(directory / "study.h5")
    unfinished = {
        task.index: task
        for task in tasks(study, directory, overwrite=overwrite)
        if _collect(task, rows) < task.steps
    }
    resumed = len(study.points) - len(unfinished)
    files = _Writer(directory)
    files.write(rows)
    messages: dict[str, None] = {}

    def keep(task: RunTask, outcome: xr.Dataset | Exception) -> tuple[str, bool]:
        del unfinished[task.index]
        if isinstance(outcome, Exception):
            _collect(task, rows)
            rows.fail(task.index, _one_line(outcome))
        else:
            rows.put(task.index, outcome)
            rows.beyond_theory[task.index] = outcome.attrs.pop(BEYOND_THEORY)
            messages.update(dict.fromkeys(outcome.attrs.pop(_WARNINGS)))
        # On a full disk all later runs would fail: writing the table at once detects that.
        files.write(rows, at_once=isinstance(outcome, StorageError))
        return _verdict(outcome)

    try:
        with BatchProgress(len(study.points), resumed, progress) as bar:
            _solve_all(study.executor, list(unfinished.values()), keep, bar, threads)
    finally:
        for task in unfinished.values():
            _collect(task, rows)
        files.write(rows, at_once=True)
        whole = rows.dataset()

        def runs() -> Runs:
            return Runs.of_study(read_only_dataset(whole), directory, study.to_json(portable=True))

        calls = runner.writers(outputs, runs, directory / "study", first)
        written = runner.all_done([partial(_or_warning, call, messages) for call in calls])
    for message in (*messages, *caveats(whole)):
        warnings.warn(message, stacklevel=4)
    return StudyResult(whole, (*files.paths, *chain(*written)), resumed)


def _solve_all(
    executor: Executor | None,
    todo: Sequence[RunTask],
    keep: Callable[[RunTask, xr.Dataset | Exception], tuple[str, bool]],
    bar: BatchProgress,
    threads: int | None,
) -> None:
    """Execute tasks and keep their outcomes.

    Without an executor they are executed in this process, until those left would take long at the
    pace of the last and can be shared.
    """
    import xarray as xr

    def solve_by(by: Executor, tasks: Sequence[RunTask]) -> None:
        mapped(by, partial(solve, threads=threads or by.threads), tasks, xr.Dataset, keep, bar)

    while todo and executor is None:
        task, *todo = todo
        start = time.monotonic()
        solve_by(registry().make(Executor, {"type": DEFAULT_EXECUTOR}), [task])
        left = len(todo) * (time.monotonic() - start)
        if left > _LONG and _can_share(todo, threads or 1):
            executor = registry().make(Executor, {"type": "processes", "threads": threads or 1})
            bar.say(
                f"the other {len(todo)} runs would take {left:.0f} s here: they go to processes, "
                "as many as cores and memory allow (study.executor decides otherwise)"
            )
    if executor:
        solve_by(executor, todo)


def _can_share(todo: Sequence[RunTask], threads: int) -> bool:
    """Return whether two of the tasks can be executed at once, each in a process of its own.

    A process that another one started leaves the cores to its siblings.
    """
    if min(len(todo), runner.available_cores() // threads) < 2 or parent_process():
        return False
    available = memory.available()
    needed = 2 * (max(task.memory for task in todo) + memory.PROCESS)
    return available is None or needed <= available


def solve(task: RunTask, say: Say, threads: int | None) -> xr.Dataset:
    """Solve a run in a worker, write its files, and return its numbers.

    Warnings are stored in the attributes, so that a warning is shown once for all runs.
    """
    bar = ProgressReporter(task.steps, say)
    with _recorded_warnings() as caught:
        executed = runner.execute(
            task.run, task.journal, task.outputs, bar, threads=threads, lock=False
        )
    messages = [str(warning.message) for warning in caught]
    numbers = executed.result.dataset.drop_dims(["x", "y"])
    beyond = "; ".join(executed.result.beyond_theory().values())
    return numbers.assign_attrs({_WARNINGS: messages, BEYOND_THEORY: beyond})


@contextmanager
def _recorded_warnings() -> Iterator[list[warnings.WarningMessage]]:
    """Yield the list of warnings within this context, in one thread at a time.

    How warnings are shown belongs to the process: of two threads that record them at the same time
    the second would leave it to the record of the first, so that no warning is shown any more.
    Warnings of another thread are recorded here, or shown as usual.
    """
    if not _recording.acquire(blocking=False):
        yield []
        return
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", UserWarning)
            yield caught
    finally:
        _recording.release()


class Planned(NamedTuple):
    """A run before it is executed."""

    task: RunTask
    finished: int
    """Number of steps in its file."""
    problem: str
    """Reason why its file cannot be used; empty if it can."""


def plan(runs: Sequence[RunTask]) -> Iterator[Planned]:
    """Yield each run with the number of its finished steps."""
    for task in runs:
        try:
            numbers = task.journal.numbers()
        except StorageError as error:
            yield Planned(task, 0, str(error))
        else:
            yield Planned(task, 0 if numbers is None else numbers.sizes["step"], "")


def read(path: Path) -> tuple[xr.Dataset, Path]:
    """Return the table of a study and its folder, given the folder or its ``study.h5``.

    Raises
    ------
    StorageError
        The table does not exist or cannot be read.
    """
    whole = path / "study.h5" if is_folder(path) else path
    dataset = storage.table(whole)
    if problem := table.damage(dataset):
        raise StorageError(f"{whole}: {problem}, so it is damaged; run the study again")
    rows = with_paths(dataset)
    if Status.NOT_RUN.name in rows["status_code"].values:
        rows = _completed(rows, whole.parent)
    return rows, whole.parent


def _completed(rows: xr.Dataset, directory: Path) -> xr.Dataset:
    """Return the table with the steps in the files of its runs, which a kill leaves ahead of it."""
    try:
        study = Study.of(json.loads(rows.attrs["configuration"]))
        runs = tasks(study, directory)
    except (ConfigError, PluginError):
        # A file that it reads, or a plugin, may be gone.
        return rows
    current = table.StudyTable(study)
    current.recall(directory / "study.h5")
    of_steps = rows[[name for name in rows.data_vars if "step" in rows[name].dims]]
    for task in runs:
        current.put(task.index, of_steps.isel(dict(zip(study.dimensions, task.index, strict=True))))
        _collect(task, current)
    return current.dataset().assign_attrs(rows.attrs)


def is_table(path: Path) -> bool:
    """Return whether a path is the folder of a study, or its table.

    The result of a single run has the name of the table if its run file is called ``study.toml``.
    """
    whole = path / "study.h5" if is_folder(path) else path
    if whole.name != "study.h5" or (whole != path and not is_file(whole)):
        return False
    try:
        storage.attributes(whole)
    except StorageError:
        return True
    return False


def _or_warning(
    write: Callable[[], tuple[Path, ...]], messages: dict[str, None]
) -> tuple[Path, ...]:
    """Return the files of an output; settings that do not fit are added to the messages."""
    try:
        return write()
    except ConfigError as error:
        messages[str(error)] = None
        return ()


def _collect(task: RunTask, rows: table.StudyTable) -> int:
    """Copy the steps in the file of a run into the table; return their number."""
    try:
        numbers = task.journal.numbers()
    except StorageError:
        # The run itself will fail with this error, whose message names the remedy.
        return 0
    if numbers is None:
        return 0
    rows.put(task.index, numbers)
    return numbers.sizes["step"]


def _require_table(path: Path, overwrite: bool) -> None:
    """Refuse to replace a file that is not the table of a study."""
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
    _, _, verdict = progress_of(outcome)
    return verdict, verdict != "converged"


def _one_line(error: Exception) -> str:
    message = "; ".join(str(error).splitlines()) or "no reason given"
    is_ours = isinstance(error, (ConfigError, StorageError))
    return message if is_ours else f"{type(error).__name__}: {message}"


class _Writer:
    """Keeps the files of the table up to date, spending a small share of the time of the study."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._next = 0.0
        self.paths: tuple[Path, ...] = ()

    def write(self, rows: table.StudyTable, *, at_once: bool = False) -> None:
        start = time.monotonic()
        if start < self._next and not at_once:
            return
        self.paths = table.write(rows.dataset(), self._directory)
        end = time.monotonic()
        self._next = end + (end - start) / _TABLE_SHARE
