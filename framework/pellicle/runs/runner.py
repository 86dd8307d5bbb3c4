"""A run from configuration to result: compose, solve every load step, hand to the outputs."""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack, closing
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from pellicle import memory
from pellicle.checks import blamed, checked_threads, read_only_dataset
from pellicle.components import Output, Place
from pellicle.components.calls import (
    earlier_steps,
    files_of,
    hand_over,
)
from pellicle.config.run import Run
from pellicle.errors import ConfigError, ConvergenceWarning
from pellicle.grid import Grid
from pellicle.plugins import registry
from pellicle.results.result import Result, said_of_steps
from pellicle.results.step import Steps

from .lock import locked
from .progress import Bar, Progress

if TYPE_CHECKING:
    import xarray as xr
from .compose import compose
from .steps import solve_steps

STANDARD_OUTPUTS = ("hdf5", "csv", "figures")


# Points of a transform from which on threads pay.
_LARGE = 2048**2


def run(
    configuration: Run | Mapping[str, Any] | str | Path,
    *,
    directory: str | Path | None = None,
    progress: bool = True,
    threads: int | None = None,
    overwrite: bool = False,
) -> Result:
    """Solve every load step of a run.

    Parameters
    ----------
    configuration
        A `Run`, the path of a TOML file, or a mapping of the same form.
    directory
        Where the outputs go. Without it nothing is written, unless the configuration names
        outputs: these go to the current folder.
    progress
        Show a bar, if there is a terminal.
    threads
        Threads of the Fourier transforms, a whole number ≥ 1; None for `default_threads`.
    overwrite
        Begin anew, in place of whatever result is there. Otherwise the steps that the folder holds
        of the same run are taken from there, and what is of another run is refused.

    Raises
    ------
    ConfigError, PluginError, StorageError
        The run cannot be made, or another process writes to the same files; what was computed
        before is kept.

    Warns
    -----
    ConvergenceWarning
        A step is in the result but marked: as not converged, or as too coarse.
    """
    threads = checked_threads(threads)
    made, name = _as_run(configuration)
    outputs = standard_outputs(made.outputs) if directory is not None else made.outputs or ()
    place = Place(
        Path(directory or "."), name, made.to_json(as_given=True), made.identity, overwrite
    )
    bar = Progress(len(made.loading.values), progress)
    result = execute(made, place, outputs, bar, threads=threads).result
    for step, message in result.failures():
        warnings.warn(f"step {step}: {message}", ConvergenceWarning, stacklevel=2)
    if coarse := result.coarse():
        warnings.warn(said_of_steps(coarse), ConvergenceWarning, stacklevel=2)
    return result


def solve(run: Run) -> Result:
    """Return the result of ``run``, of which nothing is written or shown."""
    nowhere = Place(Path(), "run", run.to_json(as_given=True))
    return execute(run, nowhere, (), Progress(len(run.loading.values), enabled=False)).result


class Executed(NamedTuple):
    """What came of a run."""

    result: Result
    files: tuple[Path, ...]
    """What its outputs left."""
    taken: int
    """How many of its steps an earlier process had done."""


def execute(
    run: Run,
    place: Place,
    outputs: Sequence[Output],
    bar: Bar,
    *,
    threads: int | None = None,
    lock: bool = True,
) -> Executed:
    """Solve the load steps of ``run`` that ``outputs`` do not have yet at ``place``.

    On an interruption the outputs still get the steps that are finished. No other process may write
    there meanwhile; without ``lock`` the caller sees to that.
    """
    import scipy.fft

    memory.require(run.grid, len(run.loading.values), run.solver)
    steps = Steps(len(run.loading.values))
    files: list[Path] = []
    with scipy.fft.set_workers(threads or default_threads(run.grid)), bar, ExitStack() as stack:
        try:
            solved = solve_steps(run, compose(run), steps, bar)
            if outputs and lock:
                stack.enter_context(locked(place.directory, place.name))
            for output in outputs:
                with blamed(output):
                    output.open(place)
            steps.extend(_resume(outputs, place, len(run.loading.values)))
            taken = len(steps)
            # closing frees the operator before the outputs draw.
            with closing(solved):
                for step in solved:
                    hand_over(outputs, place, step)
        except MemoryError:
            raise ConfigError(
                f"{run.grid.points} cells do not fit in memory; use fewer points", "grid.points"
            ) from None
        finally:
            if steps:
                result = Result(steps.joined())
                files = left_by(
                    outputs,
                    "close()",
                    lambda output: output.close(place, Result(read_only_dataset(result.dataset))),
                    run.outputs,
                )
    return Executed(result, tuple(files), taken)


def left_by(
    outputs: Sequence[Output],
    call: str,
    leave: Callable[[Output], Iterable[Path]],
    named: Sequence[Output] | None,
) -> list[Path]:
    """Return the files that outputs leave; one that fails does not keep the others from it.

    ``call`` is the name of the method that ``leave`` calls. ``named`` are the outputs of the
    configuration, by which a field is found.
    """
    files: list[Path] = []
    errors: list[Exception] = []
    for output in outputs:
        try:
            files.extend(files_of(output, call, leave))
        except ConfigError as error:
            at = [index for index, each in enumerate(named or ()) if each is output]
            errors.append(error.within(f"outputs.{at[0]}") if at else error)
        except Exception as error:
            errors.append(error)
    if errors:
        raise errors[0]
    return files


def _resume(outputs: Sequence[Output], place: Place, number: int) -> list[xr.Dataset]:
    """Return the steps, of a ``number``, that the first output which has any has, one by one."""
    for source in outputs:
        held = earlier_steps(source, place, number)
        if held is None:
            continue
        steps = [held.isel(step=[index]) for index in range(held.sizes["step"])]
        others = [output for output in outputs if output is not source]
        for step in steps:
            hand_over(others, place, step)
        return steps
    return []


def _as_run(configuration: Run | Mapping[str, Any] | str | Path) -> tuple[Run, str]:
    made = Run.of(configuration)
    if isinstance(configuration, (str, Path)):
        return made, Path(configuration).stem
    return made, _file_stem(made.title)


def _file_stem(title: str) -> str:
    """Return a file name made of a title."""
    return re.sub(r"\W+", "-", title).strip("-").lower() or "run"


def standard_outputs(named: Sequence[Output] | None) -> Sequence[Output]:
    """Return the outputs that are named, or the standard ones if it is not said which."""
    if named is not None:
        return named
    return [registry().make(Output, {"type": type_}) for type_ in STANDARD_OUTPUTS]


def default_threads(grid: Grid) -> int:
    """Return the number of threads that solve fastest: 1 on all but large grids, else all cores.

    Transforms of fewer than 2048² points share badly, and all but the transforms runs on one
    thread. On two cores, a periodic grid of 512² took 0.26 s on one thread and 0.39 s on two, one
    of 1024² 1.00 and 1.23 s, one of 2048² 5.5 and 4.4 s. A free boundary transforms arrays of twice
    the points each way, so that a free grid of 1024² is a large one.
    """
    nx, ny = grid.points
    transformed = nx * ny * (4 if grid.boundary == "free" else 1)
    if transformed < _LARGE:
        return 1
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
