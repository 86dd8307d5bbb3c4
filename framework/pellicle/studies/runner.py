"""Execute the unfinished runs of a study and collect the numbers of all runs in its table."""

from __future__ import annotations

import json
import tempfile
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import dataclass
from functools import partial
from itertools import chain
from multiprocessing import parent_process
from pathlib import Path
from typing import Any

import xarray as xr

from pellicle import memory
from pellicle.batch import BatchProgress, lock_files, run_tasks
from pellicle.checks import checked_threads, read_only_dataset
from pellicle.components import Executor, Output, Say
from pellicle.components.installed import registry
from pellicle.config.doubtful_scales import warn_of_scale as warn_of_scale
from pellicle.config.run import Run
from pellicle.config.study import DEFAULT_EXECUTOR, Study
from pellicle.config.study import from_toml as from_toml
from pellicle.contact.caveats import Status
from pellicle.errors import ConfigError, ConvergenceWarning, PellicleError, StorageError
from pellicle.files import check_writable, is_file, is_folder
from pellicle.results import storage
from pellicle.results.dimensions import with_paths, with_python_names
from pellicle.results.path import with_events
from pellicle.results.runs import StoredRuns, progress_of
from pellicle.results.soundness import check, sound
from pellicle.runs import runner
from pellicle.runs.journal import Journal
from pellicle.runs.lock import LockedError
from pellicle.runs.memory_estimate import memory_of
from pellicle.runs.outputs import call_all, standard_outputs, writers
from pellicle.runs.progress import progress_monitor
from pellicle.show.sentences import caveats, failures, run_names, shared_among_processes

from . import table

_LONG = 10.0
"""Time [s] of the runs that are left, one after the other, from which processes share them."""
WARNINGS = "warnings"
SOLVED_ELSEWHERE = "another process solves it"
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
        return int(memory_of(self.run))

    @property
    def steps(self) -> int:
        """Number of load steps of the whole run."""
        return self.run.steps

    def read_steps(self) -> tuple[xr.Dataset | None, int, str]:
        """Return the steps in its file, if any, their number, and why it cannot be used, if so."""
        try:
            numbers = self.journal.finished()
        except StorageError as error:
            return None, 0, str(error)
        return numbers, 0 if numbers is None else numbers.sizes["step"], ""


def run_study(
    configuration: Study | Mapping[str, Any] | str | Path,
    directory: str | Path | None = None,
    *,
    progress: bool = True,
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
    UserWarning
        A value is out of scale with the others, as one without its unit is.
    """
    threads = checked_threads(threads)
    study = Study.of(configuration)
    with tempfile.TemporaryDirectory() as temporary:
        rows = execute(
            study,
            Path(directory or temporary),
            progress=progress,
            overwrite=overwrite,
            threads=threads,
        ).result
    if message := failures(rows):
        warnings.warn(f"{message}; see status", ConvergenceWarning, stacklevel=2)
    return with_python_names(rows)


def plan_runs(configuration: Run | Study, stem: Path, *, overwrite: bool = False) -> list[RunTask]:
    """Return the run of a configuration, or those of a study, finished or not.

    ``stem`` is the path of the files of a run without their suffixes; a study is in its folder. The
    outputs of a study have to fit it.
    """
    if isinstance(configuration, Run):
        journal = Journal(stem, configuration.identity, overwrite)
        return [RunTask(configuration.title or stem.name, configuration, journal)]
    table.check_outputs(configuration)
    points, folder = configuration.points, stem.with_name("runs")
    outputs = tuple(o for o in points[0].run.outputs or () if o.scope == "run")
    names = run_names(table.StudyTable(configuration).dataset())
    tasks = []
    for name, point in zip(names, points, strict=True):
        identity = point.run.identity
        journal = Journal(folder / identity[:16], identity, overwrite)
        tasks.append(RunTask(name, point.run, journal, point.position, outputs))
    return tasks


def execute(
    study: Study,
    directory: Path,
    *,
    progress: bool = False,
    overwrite: bool = False,
    threads: int | None = None,
    wait: bool = False,
) -> runner.RunOutcome[xr.Dataset]:
    """Solve the runs of a study that are not finished, and write its table and outputs.

    After an interruption these show the finished steps. One process at a time writes the table, for
    which others ``wait`` or are refused; a run that one of them solves is left to it.
    """
    warn_of_scale(study)
    with lock_files(directory, "study", wait=wait):
        path, first = directory / "study.h5", study.points[0].run
        rows, unfinished = _begun(study, path, overwrite)
        resumed = len(study.points) - len(unfinished)
        rows.write(directory)
        messages: dict[str, None] = {}

        def keep(task: RunTask, outcome: xr.Dataset | Exception) -> tuple[str, bool]:
            if isinstance(outcome, LockedError):
                return SOLVED_ELSEWHERE, False
            del unfinished[task.index]
            if isinstance(outcome, Exception):
                _collect(task, rows)
                verdict = rows.fail(task.index, reason_of(outcome))
            else:
                rows.put(task.index, outcome)
                messages.update(dict.fromkeys(outcome.attrs[WARNINGS]))
                _, _, verdict = progress_of(outcome)
            # On a full disk all later runs would fail: writing the table at once detects that.
            rows.write(directory, at_once=isinstance(outcome, StorageError))
            return verdict, verdict != "converged"

        def runs() -> StoredRuns:
            configuration = study.to_json(portable=True)
            return StoredRuns.of_study(read_only_dataset(whole), directory, configuration)

        def written(write: Callable[[], tuple[Path, ...]]) -> tuple[Path, ...]:
            try:
                return write()
            except ConfigError as error:
                messages[str(error)] = None
                return ()

        try:
            with BatchProgress(len(study.points), resumed, progress) as bar:
                _solve_all(study.executor, list(unfinished.values()), keep, bar, threads)
        finally:
            for task in unfinished.values():
                _collect(task, rows)
            rows.write(directory, at_once=True)
            whole = rows.dataset()
            outputs = [o for o in standard_outputs(first.outputs) if o.scope != "run"]
            calls = writers(outputs, runs, directory / "study", first)
            of_outputs = call_all([partial(written, call) for call in calls])
    for message in (*messages, *caveats(whole)):
        warnings.warn(message, stacklevel=3)
    return runner.RunOutcome(whole, (*rows.files, *chain(*of_outputs)), resumed)


def reason_of(error: Exception) -> str:
    """Return why a run failed, on one line."""
    reason = "; ".join(str(error).splitlines()) or "no reason given"
    kind = "" if isinstance(error, (ConfigError, StorageError)) else f"{type(error).__name__}: "
    return f"{kind}{reason}"


def _begun(
    study: Study, path: Path, overwrite: bool
) -> tuple[table.StudyTable, dict[tuple[int, ...], RunTask]]:
    """Return the table of a study with the steps on disk, and the unfinished runs by index."""
    check_writable(path)
    check_writable(path.parent / "runs" / "run.h5")
    rows = table.StudyTable(study)
    if not overwrite and path.exists():
        # A file that is not the table of a study is not replaced.
        try:
            storage.table(path)
        except StorageError as error:
            raise StorageError(f"{error}; {storage.REPLACING}") from None
    tasks = plan_runs(study, path)
    if overwrite:
        # Otherwise an interruption would leave results of before among the new ones.
        for task in tasks:
            storage.remove(task.journal.path)
    return rows, {task.index: task for task in tasks if _collect(task, rows) < task.steps}


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

    def solve_by(by: Executor, tasks: Sequence[RunTask]) -> None:
        by = with_threads(by, threads)
        run_tasks(by, partial(solve, threads=by.threads), tasks, xr.Dataset, keep, bar)

    while todo and executor is None:
        task, *todo = todo
        start = time.monotonic()
        solve_by(registry().make(Executor, {"type": DEFAULT_EXECUTOR}), [task])
        left = len(todo) * (time.monotonic() - start)
        # A process that another one started leaves the cores to its siblings.
        crowded = parent_process() or min(len(todo), runner.available_cores() // (threads or 1)) < 2
        if left <= _LONG or crowded:
            continue
        needed = 2 * (max(task.memory for task in todo) + memory.PROCESS)
        if (available := memory.available()) is None or needed <= available:
            executor = registry().make(Executor, {"type": "processes"})
            bar.say(shared_among_processes(len(todo), left))
    if executor:
        solve_by(executor, todo)


def with_threads(executor: Executor, threads: int | None) -> Executor:
    """Return an executor that gives each run so many threads; its own number if none is given."""
    return executor.model_copy(update={"threads": threads}) if threads else executor


def solve(task: RunTask, say: Say, threads: int | None) -> xr.Dataset:
    """Solve a run in a worker, write its files, and return its numbers.

    Warnings are stored in the attributes, so that a warning is shown once for all runs. Another
    process may have finished the run since it was planned.
    """
    numbers, count, _ = task.read_steps()
    if numbers is not None and count == task.steps:
        return with_events(numbers).assign_attrs({WARNINGS: []})
    bar = nullcontext(partial(progress_monitor, steps=task.steps, show=say))
    with _recorded_warnings() as caught:
        executed = runner.execute(
            task.run, task.journal, task.outputs, bar, threads=threads, inner=True
        )
    messages = [str(warning.message) for warning in caught]
    numbers = executed.result.dataset.drop_dims(["x", "y"])
    return numbers.assign_attrs({WARNINGS: messages})


@contextmanager
def _recorded_warnings() -> Iterator[list[warnings.WarningMessage]]:
    """Yield the list of warnings within this context, in one thread at a time.

    How warnings are shown belongs to the process: of two threads that record them at the same time
    the second would leave it to the record of the first, so that no warning is shown any more.
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


def _collect(task: RunTask, rows: table.StudyTable) -> int:
    """Copy the steps in the file of a run into the table; return their number."""
    # A run whose file cannot be used will fail with a message that names the remedy.
    numbers, count, _ = task.read_steps()
    if numbers is not None:
        rows.put(task.index, with_events(numbers))
    return count


def read(path: Path) -> tuple[xr.Dataset, Path]:
    """Return the table of a study and its folder, given the folder or its ``study.h5``.

    A kill may leave finished steps out of the table; they are read from the files of the runs.
    """
    whole = path / "study.h5" if is_folder(path) else path
    table = storage.table(whole)
    with sound(whole):
        check(table)
        rows = with_paths(table)
    if Status.NOT_RUN.name in rows["status_code"].values:
        # Where a file that the study names is gone, the table is shown as it was left.
        with suppress(PellicleError):
            rows = _completed(rows, whole)
    return rows, whole.parent


def _completed(earlier: xr.Dataset, path: Path) -> xr.Dataset:
    """Return an unfinished table with all steps that the files of its runs hold."""
    study = Study.from_mapping(json.loads(earlier.attrs["configuration"]))
    rows, statuses = table.StudyTable(study), earlier["status"].values
    for task in plan_runs(study, path):
        _collect(task, rows)
        failed = earlier["status_code"].values[task.index] == Status.FAILED.name
        for sentence in statuses[task.index][failed][:1]:
            rows.fail(task.index, sentence.removeprefix(Status.FAILED.value.format(reason="")))
    return rows.dataset().assign_attrs(earlier.attrs)


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
