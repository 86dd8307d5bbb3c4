"""Calls of components: one function for each method that the framework calls.

Arguments of components are read-only. Returned values are checked against the contract, at a cost
far below that of the call. `pellicle.operators` calls kernels in the same way.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from numbers import Integral
from pathlib import Path
from typing import Any, TypeVar, cast, get_args

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.checks import (
    component_name,
    errors_attributed_to,
    read_only,
    real_array,
    real_number,
)
from pellicle.errors import ConfigError, PluginError, shown
from pellicle.grid import LARGEST, Grid
from pellicle.numerics.path import Start
from pellicle.numerics.problem import Depth, Equilibrium, Force, Problem
from pellicle.numerics.relaxation import Branch
from pellicle.numerics.solution import Solution, State, Stop
from pellicle.units import DIGITS, readable

from .correction import AreaCorrection
from .executor import AnyTask, Executor, Outcome, Report, Say
from .indenter import (
    Footprint,
    ForceCurve,
    HasForceCurve,
    HasLayerForceCurve,
    Indenter,
    LayerForceCurve,
)
from .kernel import HasRelaxation, Kernel
from .output import Output, Runs, stem_of
from .prescription import Prescription, Search, Setting
from .solver import Monitor, Solver

# Rounding error of heights over the size of the domain, and relative rounding error of areas.
# How Python refuses a State used as an array, which it was in earlier versions.
_OUTDATED = "'State'|State is not an array|can't multiply sequence|argument 'pressure'"
_ROUNDING = 1e-12
_Curve = TypeVar("_Curve", ForceCurve, LayerForceCurve)


def profile_of(indenter: Indenter, grid: Grid) -> Array:
    """Return the profile f ≤ 0 [m] of an indenter on a grid, read-only.

    Raises
    ------
    ConfigError
        The indenter cannot be put on this grid, or has heights that are positive or NaN.
    PluginError
        The profile is not an array of the grid's shape, or is not near 0 anywhere.
    """
    x, y = (read_only(points) for points in grid.coordinates())
    try:
        with errors_attributed_to(indenter), np.errstate(over="raise"):
            value = indenter.profile(x, y)
            footprint = indenter.footprint
    except ConfigError as error:
        raise error.within("indenter") from None
    except (OverflowError, FloatingPointError):
        raise _beyond_numbers("overflow") from None
    profile = real_array(indenter, "profile(x, y)", value, grid.shape)
    name = component_name(indenter)
    if footprint not in get_args(Footprint):
        raise PluginError(
            f"{name}: footprint is {shown(footprint)}; it has to be 'unbounded' or 'domain'"
        )
    if np.isneginf(profile).all():
        cells, domain = (
            " × ".join(readable(edge, "m", DIGITS) for edge in edges)
            for edges in (grid.spacing, grid.size)
        )
        raise ConfigError(
            f"cells of {cells} are wider than {name}, which lies over no cell centre; use a "
            f"smaller grid.size, which is {domain}, or more points",
            "indenter",
        )
    if not (profile <= 0).all():
        raise ConfigError(
            f"the profile of {name} has values that are positive or NaN; it must be ≤ 0 "
            "everywhere and 0 at the lowest point",
            "indenter",
        )
    height = -float(profile.min(where=np.isfinite(profile), initial=0.0))
    if height and not 1 / LARGEST < height < LARGEST:
        raise _beyond_numbers(f"reach {height:g} m")
    highest = float(profile.max())
    rounding = _ROUNDING * max(grid.size)
    if highest < -rounding and highest < -(hidden := _hidden_height(profile, footprint)):
        raise PluginError(
            f"{name}: the highest value of profile(x, y) is {highest:.3g} m, further below 0 than "
            f"the {hidden:.3g} m by which neighbouring cells differ; it has to be 0 at the lowest "
            "point"
        )
    return read_only(np.ascontiguousarray(profile))


def _beyond_numbers(what: str) -> ConfigError:
    return ConfigError(
        f"its heights on this grid {what}, and squares of them are beyond the numbers that a "
        "computer has; check the units of its lengths",
        "indenter",
    )


def _hidden_height(profile: Array, footprint: Footprint) -> float:
    """Return an upper bound [m] on the height of the lowest cell above the lowest point.

    If the apex of a smooth body lies between the cells, the lowest cell is closer to it in height
    than to the highest of its neighbours. The apex of a rough surface may be elsewhere, so the
    largest step between any two neighbours is the bound. The apex of an unbounded body may also lie
    beyond the edge of the domain.
    """
    if footprint == "domain":
        with np.errstate(invalid="ignore"):
            steps = [np.abs(np.diff(profile, axis=axis)) for axis in (0, 1)]
        return max(
            float(np.nan_to_num(step, nan=0.0, posinf=np.inf).max(initial=0)) for step in steps
        )
    top = float(profile.max())
    i, j = np.nonzero(profile[1:-1, 1:-1] == top)
    if not i.size:
        return np.inf
    lowest_around = np.min([profile[i + a, j + b] for a in range(3) for b in range(3)], axis=0)
    return top - float(lowest_around.max())


def branches_of(kernel: Kernel) -> tuple[Branch, ...]:
    """Return the branches of a kernel that relaxes; none of one that is elastic.

    Raises
    ------
    PluginError
        The branches are not pairs of a positive share and a positive finite time, or their shares
        sum to more than 1.
    """
    if not isinstance(kernel, HasRelaxation):
        return ()
    with errors_attributed_to(kernel):
        value = tuple(Branch(*branch) for branch in kernel.branches())
    branches = tuple(
        Branch(*(real_number(kernel, f"branches() {name}", v) for name, v in b._asdict().items()))
        for b in value
    )
    total = math.fsum(branch.share for branch in branches)
    if not all(b.share > 0 and 0 < b.time < math.inf for b in branches) or total > 1 + _ROUNDING:
        raise PluginError(
            f"{component_name(kernel)}: branches() returned {shown(branches)}; shares and times "
            "have to be positive and finite, and the shares sum to at most 1"
        )
    return branches


def instantaneous(kernel: Kernel) -> Kernel:
    """Return the elastic kernel of the instantaneous response; an elastic kernel itself.

    It may have a closed form, which a kernel that relaxes need not have.
    """
    return kernel.scaled(1.0) if isinstance(kernel, HasRelaxation) else kernel


def force_curve_of(indenter: HasForceCurve, depth: Array, length: float) -> ForceCurve:
    """Return force over reduced modulus and its derivatives at depths of shape (n,) [m].

    Raises
    ------
    PluginError
        The curve is not three arrays of that shape, finite at every finite depth.
    """
    with errors_attributed_to(indenter):
        value = indenter.force_curve(read_only(depth), length)
    call = "force_curve(depth, length)"
    return _checked_curve(indenter, call, ForceCurve, value, depth, length)


def layer_force_curve_of(
    indenter: HasLayerForceCurve,
    depth: Array,
    length: float,
    thickness: float,
    poissons_ratio: float,
) -> LayerForceCurve:
    """Return force over reduced modulus on a layer and its derivatives, as `force_curve_of`.

    Raises
    ------
    PluginError
        The curve is not four arrays of the shape of ``depth``, finite at every finite depth.
    """
    with errors_attributed_to(indenter):
        value = indenter.layer_force_curve(read_only(depth), length, thickness, poissons_ratio)
    call = "layer_force_curve(depth, length, thickness, poissons_ratio)"
    return _checked_curve(indenter, call, LayerForceCurve, value, depth, length)


def _checked_curve(
    indenter: object, call: str, kind: type[_Curve], value: object, depth: Array, length: float
) -> _Curve:
    """Return a force curve of finite arrays of the shape of ``depth``, or raise PluginError."""
    name = component_name(indenter)
    if not isinstance(value, kind):
        raise PluginError(
            f"{name}: {call} returned {shown(value)}; it has to return a pellicle.{kind.__name__}"
        )
    arrays = {
        part: real_array(indenter, f"{call}.{part}", values, depth.shape)
        for part, values in value._asdict().items()
    }
    for part, values in arrays.items():
        if not np.isfinite(values[np.isfinite(depth)]).all():
            raise PluginError(
                f"{name}: {call}.{part} has values that are NaN or infinite, "
                f"for length = {length:.3g} m; it has to be finite"
            )
    return kind(**arrays)


def solution_of(
    solver: Solver, problem: Problem, start: State | None, monitor: Monitor
) -> Solution:
    """Return the solution of a load step, with a copy of its pressure.

    A negative or non-finite pressure is accepted here; the status of the step reports it.

    Raises
    ------
    ConfigError
        The solver refuses the problem.
    PluginError
        The solver does not return a `Solution` of the grid's shape, changes the problem, or treats
        ``start`` as an array, which it was in earlier versions.
    """
    name = component_name(solver)
    check_solver(solver, problem)
    adheres = problem.law is not None
    sticks = adheres and start is not None and start.is_loaded
    if not problem.needs_solving and not sticks:
        nothing = np.zeros(problem.grid.shape)
        state: State | Array = nothing
        stop = Stop.DONE
        if adheres:
            state = State(nothing, nothing, problem.depth(np.zeros(1)))
            stop = Stop.DONE if problem.prescribed == "depth" else Stop.PULLED_OFF
        return Solution(state, 0, stop)
    view = _read_only_problem(problem)
    fields, parts = dict(vars(view)), problem.operator.parts()
    try:
        with errors_attributed_to(solver):
            value = solver.solve(view, None if start is None else _read_only_state(start), monitor)
    except (AttributeError, TypeError) as error:
        if not re.search(_OUTDATED, str(error)):
            raise
        raise PluginError(
            f"{' '.join(error.__notes__)}: {error}; solve() starts from None or a pellicle.State, "
            "not an array: its pressure is start.pressure; it returns "
            "pellicle.Solution(pressure or state, iterations, stop)"
        ) from error
    _require_unchanged(solver, "solve()", fields, dict(vars(view)), "problem")
    _require_unchanged(solver, "solve()", parts, problem.operator.parts(), "problem.operator")
    if not isinstance(value, Solution):
        raise PluginError(
            f"{name}: solve() returned {shown(value)}; it has to return a pellicle.Solution"
        )
    pressure = real_array(solver, "solve().pressure", value.pressure, problem.grid.shape)
    if not isinstance(value.iterations, Integral) or not isinstance(value.stop, Stop):
        raise PluginError(
            f"{name}: solve() returned iterations {shown(value.iterations)} and stop "
            f"{shown(value.stop)}; they have to be a whole number and a pellicle.Stop"
        )
    # The solver may reuse the memory of the arrays that it returned.
    pressure = pressure.copy()
    state = pressure
    if adheres:
        if not isinstance(value.state, State):
            raise PluginError(
                f"{name}: solve() returned a pressure alone; with an interaction it has to return "
                "a pellicle.State with the wall pressure"
            )
        wall = real_array(solver, "solve().state.wall", value.state.wall, problem.grid.shape)
        depth = real_number(solver, "solve().state.depth", value.state.depth)
        state = State(pressure, wall.copy(), depth)
    jumped = bool(value.jumped) or (adheres and _in_contact(state) != _in_contact(start))
    return Solution(
        state, int(value.iterations), value.stop, jumped, adheres and bool(value.extrapolated)
    )


def _in_contact(state: State | Array | None) -> bool:
    return isinstance(state, State) and bool(state.contact.any())


def check_solver(solver: Solver, problem: Problem) -> None:
    """Let a solver refuse a problem.

    Raises
    ------
    ConfigError
        The solver cannot solve the problem.
    """
    with errors_attributed_to(solver):
        reason = solver.refuses(problem)
    if reason:
        raise ConfigError(f"{component_name(solver)} {reason}", "solver.type")


def response_of(solver: Solver, problem: Problem, state: State, monitor: Monitor) -> Array:
    """Return dp/dδ [Pa/m] with the contact of ``state`` fixed.

    Raises
    ------
    PluginError
        The result is not an array of the grid's shape, or not 0 off the contact.
    """
    view, parts = _read_only_problem(problem), problem.operator.parts()
    with errors_attributed_to(solver):
        value = solver.response(view, _read_only_state(state), monitor)
    _require_unchanged(solver, "response()", parts, problem.operator.parts(), "problem.operator")
    pressure = real_array(solver, "response()", value, problem.grid.shape)
    if problem.law is None and pressure[~state.contact].any():
        raise PluginError(
            f"{component_name(solver)}: response() returned a pressure off the contact; it has to "
            "be 0 there"
        )
    return pressure


def _read_only_problem(problem: Problem) -> Problem:
    return replace(problem, profile=read_only(problem.profile))


def _read_only_state(state: State) -> State:
    pressure = read_only(state.pressure)
    wall = pressure if state.wall is state.pressure else read_only(state.wall)
    view = State(pressure, wall, state.depth)
    if isinstance(state, Start) and state.ahead:
        return Start.of(view, _read_only_state(state.ahead))
    return view


def _require_unchanged(
    solver: Solver, call: str, before: dict[str, object], after: dict[str, object], what: str
) -> None:
    differences = [key for key in before | after if before.get(key) is not after.get(key)]
    if differences:
        raise PluginError(
            f"{component_name(solver)}: {call} changes {what}.{differences[0]}; a solver has to "
            "leave its problem as it is"
        )


def check_value(prescription: Prescription, setting: Setting, value: float, field: str) -> None:
    """Let a prescription check a prescribed value; its errors name ``field``.

    If an error names a field already, it keeps that one.

    Raises
    ------
    ConfigError
        The value is not allowed in this setting.
    """
    try:
        with errors_attributed_to(prescription):
            prescription.check(setting, value)
    except ConfigError as error:
        named = any(problem.field for problem in error.problems)
        raise (error if named else error.within(field)) from None


def target_of(prescription: Prescription, setting: Setting, value: float) -> Depth | Force | Search:
    """Return the depth, the force or the search for a prescribed value.

    Raises
    ------
    PluginError
        The target is of another type, or its numbers are not finite.
    """
    with errors_attributed_to(prescription):
        target = prescription.target(setting, value)
    call, name = f"target(setting, {value:g})", component_name(prescription)
    if not isinstance(target, (Depth, Force, Search)):
        raise PluginError(
            f"{name}: {call} returned {shown(target)}; it has to return a pellicle.Depth, Force "
            "or Search"
        )
    for field in ("value", "compliance", "goal", "resolution", "width", "guess"):
        number = getattr(target, field, None)
        if number is None:
            continue
        number = real_number(prescription, f"{call}.{field}", number)
        signed = field in ("goal", "guess") or (
            field == "value" and (isinstance(target, Depth) or setting.law is not None)
        )
        if not np.isfinite(number) or (number < 0 and not signed):
            allowed = "finite" if signed else "finite and ≥ 0"
            raise PluginError(f"{name}: {call}.{field} is {number:g}; it has to be {allowed}")
    if not isinstance(target, Search):
        return target
    quantity = target.measure
    if target.control not in (Depth, Force) or not callable(quantity):
        raise PluginError(
            f"{name}: {call} has to search by control = Depth or Force, with a function as measure"
        )

    def measure(step: Equilibrium) -> float:
        with errors_attributed_to(prescription):
            return real_number(prescription, f"{call}.measure(step)", quantity(step))

    return replace(target, measure=measure)


def report_of(prescription: Prescription, setting: Setting, step: Equilibrium) -> dict[str, float]:
    """Return the variables that a prescription adds to a step.

    Raises
    ------
    PluginError
        The values are not numbers, or are not those that the prescription declares.
    """
    with errors_attributed_to(prescription):
        report = prescription.report(setting, step)
    declared = {v.name for v in prescription.variables if v.kind != "residual"}
    if not isinstance(report, dict) or report.keys() != declared:
        raise PluginError(
            f"{component_name(prescription)}: report() returned {shown(report)}; it has to return "
            f"a dict of {', '.join(sorted(declared)) or 'nothing'}, as its variables declare"
        )
    return {
        name: real_number(prescription, f"report()[{name!r}]", value)
        for name, value in report.items()
    }


def corrected_area(correction: AreaCorrection, contact: Mask, grid: Grid) -> float:
    """Return the corrected area of contact [m²].

    Raises
    ------
    PluginError
        The area is not a number between 0 and the area of the domain, or not 0 without contact.
    """
    method = correction.periodic_area if grid.boundary == "periodic" else correction.area
    call = f"{method.__name__}(contact, spacing)"
    with errors_attributed_to(correction):
        value = method(read_only(contact), grid.spacing)
    area = real_number(correction, call, value)
    largest = grid.area if contact.any() else 0.0
    if not 0 <= area <= largest * (1 + _ROUNDING):
        raise PluginError(
            f"{component_name(correction)}: {call} returned {area:g} m²; it has to be between 0 "
            f"and {largest:g} m², {'the area of the domain' if largest else 'without contact'}"
        )
    return area


def files_of(output: Output, runs: Runs, stem: Path) -> tuple[Path, ...]:
    """Let an output write its files for a run or study with the given stem; return their paths.

    Raises
    ------
    PluginError
        As for `require_files`.
    """
    with errors_attributed_to(output):
        files = output.write(runs, stem_of(output, stem))
    require_files(output, files, stem)
    return tuple(files)


def require_files(output: Output, files: object, stem: Path) -> None:
    """Refuse the value that write() of an output returned unless it lists files of its own stem.

    Raises
    ------
    PluginError
        The value is not a tuple of paths that begin with the stem of the output.
    """
    own = stem_of(output, stem)
    call = f"{component_name(output)}: write(runs, stem) returned"
    if not isinstance(files, (tuple, list)) or not all(isinstance(path, Path) for path in files):
        raise PluginError(
            f"{call} {shown(files)}; it has to return a tuple of pathlib.Path, empty if there is "
            "none"
        )
    for path in files:
        if not str(path).startswith(str(own)):
            raise PluginError(f"{call} {path}; its files have to begin with the stem, {own}")


def outcomes_of(
    executor: Executor,
    work: Callable[[AnyTask, Say], Outcome],
    tasks: Sequence[AnyTask],
    report: Report[AnyTask],
    kind: type[Outcome],
) -> Generator[tuple[AnyTask, Outcome | Exception], None, None]:
    """Yield each task once with its outcome: a value of type ``kind``, or the exception raised.

    Raises
    ------
    PluginError
        The executor yields a task twice or never, an object that is not one of the tasks, or an
        outcome of another type.
    """
    name = component_name(executor)
    known = {id(task) for task in tasks}
    remaining = {id(task): task for task in tasks}
    with errors_attributed_to(executor):
        pairs: Any = executor.map(work, tasks, report)
    if not isinstance(pairs, Iterator) or not hasattr(pairs, "close"):
        raise PluginError(f"{name}: map() returned {shown(pairs)}; it has to be written with yield")
    with closing(cast("Generator[Any]", pairs)):
        for pair in _items(executor, pairs):
            if not isinstance(pair, tuple) or len(pair) != 2 or id(pair[0]) not in known:
                raise PluginError(
                    f"{name}: map() yields {shown(pair)}; it has to yield each of the tasks that "
                    "it was given, the object itself, with its outcome"
                )
            task, outcome = pair
            if remaining.pop(id(task), None) is None:
                raise PluginError(
                    f"{name}: map() yields {task.name} twice; it has to yield each task once"
                )
            if not isinstance(outcome, (kind, Exception)):
                raise PluginError(
                    f"{name}: map() yields {task.name} with {shown(outcome)}; it has to yield it "
                    "with what its work returned or raised"
                )
            yield task, outcome
    if remaining:
        first = next(iter(remaining.values()))
        raise PluginError(
            f"{name}: map() ended without {len(remaining)} of {len(tasks)} tasks, such as "
            f"{first.name}; it has to yield each task once"
        )


def _items(executor: Executor, pairs: Iterator[Any]) -> Iterator[Any]:
    """Yield the items of an executor; exceptions that it raises itself are attributed to it."""
    while True:
        with errors_attributed_to(executor):
            try:
                pair = next(pairs)
            except StopIteration:
                return
        yield pair
