"""Solve a run: create the operator, solve every load step, write the result and the outputs."""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, closing
from itertools import chain
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar

import scipy.fft
import xarray as xr

from pellicle import memory
from pellicle.checks import checked_threads, read_only_dataset
from pellicle.components import Output, Runs
from pellicle.config.doubtful_scales import warn_of_scale
from pellicle.config.run import Run
from pellicle.errors import ConfigError, ConvergenceWarning
from pellicle.grid import Grid
from pellicle.results.path import with_events
from pellicle.results.record import Steps
from pellicle.results.result import Result
from pellicle.results.runs import StoredRuns

from .compose import compose, compose_load
from .journal import Journal
from .lock import lock_files
from .memory_estimate import memory_of
from .outputs import call_all, hand_over, standard_outputs, writers
from .progress import Bar, Report, RunProgress
from .solve import solve_steps

# Bytes; most file systems allow 255, and names of temporary files hold that of the host too.
_LONGEST_STEM = 120
# Points of a transform from which threads save time.
_LARGE = 1024**2
Outcome = TypeVar("Outcome", Result, xr.Dataset)


def run(
    configuration: Run | Mapping[str, Any] | str | Path,
    *,
    directory: str | Path | None = None,
    progress: bool | Report = True,
    threads: int | None = None,
    overwrite: bool = False,
) -> Result:
    """Solve every load step of a run.

    Parameters
    ----------
    configuration
        A `Run`, the path of a TOML file, or a mapping of the same form.
    directory
        Folder of the result file and the outputs. Without it nothing is written, unless the
        configuration names outputs: then it is the current folder.
    progress
        Show a bar on a terminal or in a notebook. Or a function that is called instead at each
        iteration of a solve, of which a load step may need several, with the number of the step as
        in the result, the iteration and the residual over the tolerance. An exception that it
        raises ends the run and is raised here; finished steps are kept in ``directory``.
    threads
        Threads of the transforms and of passes over large arrays, a whole number ≥ 1; None for
        `default_threads`.
    overwrite
        Start over and replace any existing result file. Otherwise its steps are not solved again
        if they are of the same run, and the result of another run is refused.

    Raises
    ------
    ConfigError, PluginError, StorageError
        The run cannot be executed, or another process writes to the same files; finished steps
        are kept.

    Warns
    -----
    ConvergenceWarning
        A step of the result did not converge or has a caveat.
    UserWarning
        A value is out of scale with the others, as one without its unit is.
    """
    threads = checked_threads(threads)
    run = Run.of(configuration)
    if isinstance(configuration, (str, Path)):
        name = Path(configuration).stem
    else:
        title = re.sub(r"\W+", "-", run.title).lower().encode()
        name = title[:_LONGEST_STEM].decode(errors="ignore").strip("-") or "run"
    outputs = standard_outputs(run.outputs) if directory is not None else run.outputs or ()
    writes = directory is not None or bool(outputs)
    journal = Journal(Path(directory or ".") / name, run.identity, overwrite) if writes else None
    bar = RunProgress(run.steps, progress)
    result = execute(run, journal, outputs, bar, threads=threads).result
    for step, message in result.failures():
        warnings.warn(f"step {step}: {message}", ConvergenceWarning, stacklevel=2)
    for message in result.warnings():
        warnings.warn(message, ConvergenceWarning, stacklevel=2)
    return result


def solve(run: Run) -> Result:
    """Return the result of ``run``; nothing is written or shown."""
    bar = RunProgress(run.steps, False)
    return execute(run, None, (), bar, inner=True).result


class RunOutcome(NamedTuple, Generic[Outcome]):
    """The outcome of a run, or of a study, whose result is its table."""

    result: Outcome
    files: tuple[Path, ...]
    """The files of the result and of the outputs."""
    resumed: int
    """Number of steps, or of runs of a study, that an earlier process had solved."""


def execute(
    run: Run,
    journal: Journal | None,
    outputs: Sequence[Output],
    bar: Bar,
    *,
    threads: int | None = None,
    inner: bool = False,
) -> RunOutcome[Result]:
    """Solve the load steps that ``journal`` lacks and write the outputs beside it.

    After an interruption the outputs still show the finished steps. Without a journal nothing is
    written. Meanwhile another process that would write the same files is refused. The caller of an
    ``inner`` run, such as one of a study, has warned of values out of scale.
    """
    if not inner:
        warn_of_scale(run)
    memory.require(memory_of(run), run.grid, run.steps)
    steps = Steps(run.steps)
    outputs = [output for output in outputs if journal and output.scope != "study"]
    files: tuple[Path, ...] = ()

    def runs() -> Runs:
        return StoredRuns.of_run(read_only_dataset(result.dataset), run.to_json(portable=True))

    workers = scipy.fft.set_workers(threads or default_threads(run.grid))
    with workers, bar as monitor_of, ExitStack() as stack:
        try:
            composed = compose_load(run, run.load) if run.load else compose(run)
            solved = solve_steps(run, composed, steps, monitor_of)
            if journal:
                stack.enter_context(lock_files(journal.stem.parent, journal.stem.name))
                for step in journal.resume():
                    hand_over(steps.append(step), outputs, journal)
            resumed = len(steps)
            # closing frees the operator before the outputs draw.
            with closing(solved):
                for step in solved:
                    if journal:
                        hand_over(step, outputs, journal, is_new=True)
        except MemoryError:
            raise ConfigError(
                f"{run.grid.points} cells do not fit in memory; use fewer points", "grid.points"
            ) from None
        finally:
            if steps:
                result = Result(with_events(steps.join_steps()))
                if journal:
                    calls = [journal.close, *writers(outputs, runs, journal.stem, run)]
                    files = tuple(chain(*call_all(calls)))
    return RunOutcome(result, files, resumed)


def default_threads(grid: Grid) -> int:
    """Return the number of threads that solve fastest: 1 on all but large grids, else all cores.

    On two threads rough periodic grids of 512² took 0.98 to 1.04, 1024² 0.84 to 0.88 and 2048² 0.72
    to 0.77 of the time on one, free grids of 256² 1.00 to 1.04, 512² 0.83 to 0.89 and 1024² 0.75 to
    0.77: a free boundary transforms arrays of twice the points each way.
    """
    nx, ny = grid.points
    transformed = nx * ny * (4 if grid.boundary == "free" else 1)
    return 1 if transformed < _LARGE else available_cores()


def available_cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
