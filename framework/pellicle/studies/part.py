"""A part of a study: the runs that one of several processes solves, each under a lock."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from pellicle.batch import BatchProgress, LockedError, Part, run_tasks
from pellicle.components import Executor
from pellicle.components.installed import registry
from pellicle.config.study import DEFAULT_EXECUTOR, Study
from pellicle.files import check_writable
from pellicle.results.runs import progress_of
from pellicle.runs.runner import RunOutcome

from .runner import (
    SOLVED_ELSEWHERE,
    WARNINGS,
    RunTask,
    execute,
    plan_runs,
    reason_of,
    solve,
    with_threads,
)


class PartOutcome(NamedTuple):
    """What became of a part while runs of other parts are left."""

    failures: list[str]
    """A sentence for each of its runs that failed or did not converge."""
    open_runs: int
    """Number of runs of the study that are not finished."""


def execute_part(
    study: Study, directory: Path, part: Part, *, progress: bool = False, threads: int | None = None
) -> RunOutcome[xr.Dataset] | PartOutcome:
    """Solve the runs of a part that are neither finished nor locked.

    The process that finds all runs of the study finished writes its table, as `execute` does.
    """
    tasks = plan_runs(study, directory / "study.h5")
    check_writable(directory / "runs" / "run.h5")
    own = part.of(tasks)
    todo, failed, messages = runs_to_do(own), list[str](), dict[str, None]()

    def keep(task: RunTask, outcome: xr.Dataset | Exception) -> tuple[str, bool]:
        if isinstance(outcome, LockedError):
            return SOLVED_ELSEWHERE, False
        if isinstance(outcome, Exception):
            verdict = f"failed: {reason_of(outcome)}"
        else:
            messages.update(dict.fromkeys(outcome.attrs[WARNINGS]))
            _, _, verdict = progress_of(outcome)
        if verdict != "converged":
            failed.append(f"{task.name} (file runs/{task.journal.path.name}): {verdict}")
        return verdict, verdict != "converged"

    # The cores are those of other parts, too.
    executor = study.executor or registry().make(Executor, {"type": DEFAULT_EXECUTOR})
    executor = with_threads(executor, threads)
    work = partial(solve, threads=executor.threads)
    with BatchProgress(len(own), len(own) - len(todo), progress) as bar:
        run_tasks(executor, work, todo, xr.Dataset, keep, bar)
    for message in messages:
        warnings.warn(message, stacklevel=2)
    if left := len(runs_to_do(tasks)):
        return PartOutcome(failed, left)
    return execute(study, directory, progress=progress, threads=threads, wait=True)


def runs_to_do(tasks: Sequence[RunTask]) -> list[RunTask]:
    """Return the runs whose files lack steps."""
    return [task for task in tasks if task.read_steps()[1] < task.steps]
