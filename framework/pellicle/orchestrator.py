"""A run from configuration to result: compose, solve every load step, hand to the outputs."""

from __future__ import annotations

import os
import re
import time
import warnings
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from contextlib import ExitStack, closing
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from . import memory
from .area_search import Reached, reach_area
from .checks import blamed, checked_threads, read_only_dataset
from .components import Monitor, Output, Place
from .config import Run, refuse_study
from .contracts import (
    corrected_area,
    earlier_steps,
    files_of,
    hand_over,
    profile_of,
    punch_pressure_of,
    solution_of,
)
from .dataset import DESCRIPTIONS, Steps, step_dataset
from .errors import ConfigError, ConvergenceWarning
from .grid import Grid
from .lock import locked
from .operators import Array, Operator, make_operator
from .plugins import registry
from .problem import Equilibrium, Problem, Stiffness, measure, measure_stiffness
from .progress import Bar, Progress
from .provenance import provenance
from .resolution import warn_of_cells
from .result import Result, Solution, said_of_steps
from .seam import warn_of_seam
from .status import Status

if TYPE_CHECKING:
    import xarray as xr

STANDARD_OUTPUTS = ("hdf5", "csv", "figures")
# A prescribed contact area that whole cells miss by more than this share is not what was asked.
_AREA_TOLERANCE = 0.05
# Points of a transform from which on threads pay.
_LARGE = 2048**2
# Of a paraboloid nine or twelve cells have the force to 8 %, five to 14 %, fewer do not have it.
_RESOLVED = 13
_RESOLVED_ACROSS = 4


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
            problems = _problems(run)
            if outputs and lock:
                stack.enter_context(locked(place.directory, place.name))
            for output in outputs:
                with blamed(output):
                    output.open(place)
            steps.extend(_resume(outputs, place, len(problems)))
            taken = len(steps)
            # closing: the generator's arrays go before the outputs draw.
            with closing(_solve_steps(run, problems, steps, bar)) as solved:
                for step in solved:
                    hand_over(outputs, place, step)
        except MemoryError:
            raise ConfigError(
                f"{run.grid.points} cells do not fit in memory; use fewer points", "grid.points"
            ) from None
        finally:
            if steps:
                # What has been solved with makes room.
                problems.clear()
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
    if isinstance(configuration, Run):
        return configuration, _file_stem(configuration.title)
    if isinstance(configuration, Mapping):
        refuse_study(configuration)
        made = Run(**configuration)
        return made, _file_stem(made.title)
    return Run.from_toml(configuration), Path(configuration).stem


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


def _problems(run: Run) -> list[Problem]:
    """Return the problem of each load step; they share operator and profile.

    Raises
    ------
    ConfigError
        Kernel, indenter or loading do not fit the grid.
    """
    with blamed(run.kernel):
        operator = make_operator(run.kernel, run.grid)
        warn_of_cells(run.kernel.compliance, run.grid)
    profile = profile_of(run.indenter, run.grid)
    if run.indenter.footprint == "domain":
        warn_of_seam(profile, run.grid)

    def each(prescribed: Literal["depth", "force"], values: Iterable[float]) -> list[Problem]:
        return [Problem(run.grid, operator, profile, prescribed, value) for value in values]

    values = run.loading.values
    match run.loading.prescribed:
        case "depth":
            _check_depths(values, profile, operator, "depth")
            return each("depth", values)
        case "mean_plane_depth":
            mean = _mean_plane(run, profile)
            _check_depths([value - mean for value in values], profile, operator, "mean_plane_depth")
            return each("depth", [value - mean for value in values])
        case "force":
            return each("force", values)
        case "mean_pressure":
            return each("force", [value * run.grid.area for value in values])
    _check_areas(run, profile)
    # The force is searched for.
    return each("force", [0.0] * len(values))


def _mean_plane(run: Run, profile: Array) -> float:
    """Return the height [m] of the indenter's mean plane over its lowest point, ≤ 0."""
    mean = float(profile.mean())
    endless = run.grid.boundary == "free" and run.indenter.footprint == "unbounded"
    if endless or not np.isfinite(mean):
        raise ConfigError(
            "is not defined for an indenter that goes on beyond a free domain, or does not fill "
            "its domain: it has no mean plane; prescribe depth",
            "loading.mean_plane_depth",
        )
    return mean


def _check_depths(
    depths: Sequence[float], profile: Array, operator: Operator, prescribed: str
) -> None:
    """Refuse a depth [m] before first touch, or one against the mean plane no load reaches."""
    mean = float(profile.mean())
    shift = mean if prescribed == "mean_plane_depth" else 0.0
    for index, depth in enumerate(depths):
        field = f"loading.{prescribed}.{index}"
        if depth < 0:
            raise ConfigError(
                f"{depth + shift:g} m is before first touch: this indenter's lowest point is "
                f"{-mean:g} m below its mean plane; give {mean:g} m or more",
                field,
            )
        if depth >= -mean and not operator.fixes_mean:
            raise ConfigError(
                f"{depth + shift:g} m is beyond full contact: on a periodic grid the depth is "
                f"measured from the mean plane, and this indenter's is {-mean:g} m above its "
                "lowest point, at any load; give less, or prescribe mean_pressure",
                field,
            )


def _areas(run: Run) -> Sequence[float] | None:
    """Return the contact area [m²] of each load step, None if none is prescribed."""
    match run.loading.prescribed:
        case "contact_radius":
            return [np.pi * radius**2 for radius in run.loading.values]
        case "contact_area":
            return run.loading.values
    return None


def _check_areas(run: Run, profile: Array) -> None:
    """Refuse a contact area that the indenter cannot have on this grid."""
    cell = run.grid.cell_area
    there = int(np.count_nonzero(np.isfinite(profile)))
    first = int(np.count_nonzero(profile == profile.max()))
    name = run.loading.prescribed
    unit = DESCRIPTIONS[name][0]
    for index, (given, area) in enumerate(zip(run.loading.values, _areas(run) or (), strict=True)):
        whose = "the domain" if there == profile.size else "the indenter"
        problem = ""
        if area > (there + 0.5) * cell:
            problem = f"more than {whose} has, {there * cell:g} m²; give less"
        elif area > 0 and first == there:
            problem = (
                f"not to be had: the indenter is flat, and all its {there * cell:g} m² touch at "
                "once, under any load; prescribe depth or force"
            )
        elif 0 < area < (first - 0.5) * cell:
            problem = (
                f"less than the {first} cells of {cell:g} m² that touch first, all at once; give "
                "more, or use more points"
            )
        if problem:
            raise ConfigError(f"{given:g} {unit} is {problem}", f"loading.{name}.{index}")


def _solve_steps(
    run: Run, problems: Sequence[Problem], steps: Steps, bar: Bar
) -> Generator[xr.Dataset, None, None]:
    """Add each load step that ``steps`` lack as soon as it is solved, and yield it."""
    origin = provenance(run)
    first = len(steps)
    for index, problem in enumerate(problems[first:], first):
        # Only the copy in ``steps`` outlives a solve; the next one starts from its pressure.
        yield steps.append(
            _solve_step(run, index, problem, steps.pressure, bar.step(index)).assign_attrs(origin)
        )


def _solve_step(
    run: Run, index: int, problem: Problem, start: Array | None, monitor: Monitor
) -> xr.Dataset:
    """Return a load step, solved and judged."""
    started = time.perf_counter()
    applied = problem.operator.applications
    step = _solve(run, index, problem, start, monitor)
    used = problem.operator.applications - applied
    found = measure(step.problem, step.solution.pressure)
    stiffness = _stiffness(run, problem, found, monitor)
    status, message = _judge(run, index, found, step, stiffness)
    scalars = {
        **_asked(run, problem, found, step, stiffness),
        "iterations": step.solution.iterations,
        "operator_applications": used,
        "converged": status.converged,
        "status_code": status.name,
        "status": message,
        "wall_time": time.perf_counter() - started,
    }
    return step_dataset(run.grid, index + 1, found, scalars)


def _solve(
    run: Run, index: int, problem: Problem, start: Array | None, monitor: Monitor
) -> Reached:
    areas = _areas(run)
    if areas and areas[index] > 0:
        return reach_area(problem, areas[index], run.solver, start, monitor)
    if not problem.touches:
        return Reached(problem, Solution(np.zeros(run.grid.shape), 0), 0.0, "met")
    solution = solution_of(run.solver, problem, start, monitor)
    return Reached(problem, solution, 0.0, "met")


def _stiffness(
    run: Run, problem: Problem, found: Equilibrium, monitor: Monitor
) -> Stiffness | None:
    """Return the contact stiffness if it is asked for."""
    if not run.loading.stiffness:
        return None
    contact = found.contact
    if problem.is_rigid(contact):
        return Stiffness(np.inf, 0.0)
    if not contact.any():
        return Stiffness(0.0, 0.0)
    punch = punch_pressure_of(run.solver, problem, contact, monitor)
    return measure_stiffness(problem, contact, punch)


def _asked(
    run: Run, problem: Problem, found: Equilibrium, step: Reached, stiffness: Stiffness | None
) -> dict[str, float]:
    """Return the numbers that are there because the run asks for them."""
    loading = {
        "mean_plane_depth": found.depth + float(problem.profile.mean()),
        "residual_area": step.missed,
        "stiffness": stiffness.value if stiffness else np.nan,
    }
    corrected = {
        f"contact_area_{correction.type}": corrected_area(  # type: ignore[attr-defined]
            correction, found.contact, run.grid
        )
        for correction in run.corrections
    }
    return corrected | {name: loading[name] for name in loading if name in run.loading.brings}


def _judge(
    run: Run, index: int, found: Equilibrium, step: Reached, stiffness: Stiffness | None
) -> tuple[Status, str]:
    """Return the status of a step by its measured residuals, and what the user is told."""
    tolerance = run.solver.tolerance
    if not np.isfinite(found.force):
        return Status.NOT_FINITE, Status.NOT_FINITE.value
    if (lowest := float(found.pressure.min())) < 0:
        share = -lowest / float(found.pressure.max())
        return Status.NEGATIVE_PRESSURE, Status.NEGATIVE_PRESSURE.value.format(measure=share)
    for status, residual in (
        (Status.LOAD, found.residual_load),
        (Status.CONTACT_RESIDUAL, found.residual_contact),
        (Status.PENETRATION, found.residual_penetration),
        (Status.COMPLEMENTARITY, found.residual_complementarity),
        (Status.STIFFNESS, stiffness.residual if stiffness else 0.0),
    ):
        if not residual <= tolerance:
            return status, status.value.format(
                measure=residual, tolerance=tolerance, remedy=step.solution.stop.value
            )
    if run.indenter.footprint == "unbounded" and _touches_edge(run, found.contact):
        nx, ny = run.grid.size
        value, name = run.loading.values[index], run.loading.prescribed
        return Status.CONTACT_AT_EDGE, Status.CONTACT_AT_EDGE.value.format(
            size=f"{nx:g} × {ny:g} m",
            prescribed=f"loading.{name} = {value:g} {DESCRIPTIONS[name][0]}",
        )
    if step.how == "not found" or step.missed > _AREA_TOLERANCE:
        remedy = "use more points" if step.how == "nearest" else "no load was found that brings it"
        return Status.AREA, Status.AREA.value.format(
            measure=step.missed, tolerance=_AREA_TOLERANCE, remedy=remedy
        )
    if step.how == "nearest":
        return Status.NEAREST_AREA, Status.NEAREST_AREA.value.format(measure=step.missed)
    cells = int(np.count_nonzero(found.contact))
    enough = _RESOLVED_ACROSS if min(found.contact.shape) == 1 else _RESOLVED
    if step.problem.value > 0 and cells < min(enough, found.contact.size):
        return Status.COARSE, Status.COARSE.value.format(cells=cells or "none")
    return Status.CONVERGED, Status.CONVERGED.value


def _touches_edge(run: Run, contact: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> bool:
    """Whether a cell at the border is in contact.

    A period one cell wide has no border across: there the problem is plane.
    """
    plane = run.grid.boundary == "periodic"
    across = [axis for axis in (0, 1) if contact.shape[axis] > 1 or not plane]
    return any(np.take(contact, [0, -1], axis=axis).any() for axis in across)
