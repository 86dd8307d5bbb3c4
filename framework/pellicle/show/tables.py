"""The tables of runs and studies: for the terminal, pages, notebooks and files alike.

A table for people holds a list of the variables by name, and ``status``, how each step ended.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.arrays import Dataset
from pellicle.components.charts import Column, Table
from pellicle.config import describe
from pellicle.config.describe import FieldRow
from pellicle.config.run import Run
from pellicle.contact.caveats import from_text, verdict_of
from pellicle.results.derived import DERIVED
from pellicle.results.path import has_load, oscillations_of, path_variables, prescribed_variable
from pellicle.results.runs import axes_of, progress_of, runs_of, short_files
from pellicle.results.wording import column_of, means_something
from pellicle.units import axis_unit, readable
from pellicle.variables import CAVEATS, VARIABLES, names_of

if TYPE_CHECKING:
    from pydantic import BaseModel

    from pellicle.runs.validation import CheckedCase
    from pellicle.studies.runner import RunTask

_OF_PATHS = [
    *("pull_off", "pull_off_accuracy", "detach", "jump_in", "dissipated_energy"),
    *("storage_stiffness", "loss_stiffness", "phase", "cycle_dissipation"),
]
"""Variables of the path of each run of a study, for the terminal."""
_OF_PATH = "pull_off", "pull_off_accuracy", "detach", "jump_in", "work", "dissipated_energy"
"""Variables of the path of a run that has just been solved, for the terminal."""
_OF_LOAD = "force", "ridge_height", "ridge_width", "dimple_depth", "dimple_volume", "elastic_energy"
"""Variables of each step under a load, for the terminal."""
_COMPARED = 8
"""Digits of values that are compared."""
_POWERS = str.maketrans("²³", "23")


def numbers(data: Dataset) -> Table:
    """Return all numbers and texts of each step, as files have them."""
    names = [str(n) for n, variable in data.data_vars.items() if variable.dims == ("step",)]
    columns = [(name, data[name]) for name in ("step", *names)]
    return Table([Column(n, v.values.tolist(), v.attrs.get("units", "")) for n, v in columns])


def steps(data: Dataset, names: Iterable[str], caption: str = "") -> Table:
    """Return variables of each step; a residual has two digits."""
    columns = []
    for name in ("step", *names):
        if name == "status":
            columns.append(_verdicts([verdict_of(from_text(t)) for t in data[CAVEATS].values]))
        else:
            column = column_of(data[name])
            digits = 2 if name.startswith("residual_") else column.digits
            columns.append(replace(column, digits=digits))
    return Table(columns, caption)


def _verdicts(words: Sequence[str]) -> Column:
    return Column("status", words, bad=[word != "converged" for word in words])


def _is_effort(name: str) -> bool:
    # Prescriptions add residuals of their own.
    return name in names_of("effort") or name.startswith("residual_")


def _is_shown(data: Dataset, name: str) -> bool:
    """Return whether a variable describes the contact, and has finite values.

    Without a finite force the variables of a step stay in the table.
    """
    if not means_something(data, name):
        return False
    missing = not np.isfinite(data[name].values.astype(float)).any()
    return not missing or not np.isfinite(data["force"].values).any()


def _names_of_numbers(data: Dataset) -> list[str]:
    return [
        str(name)
        for name, variable in data.data_vars.items()
        if "step" in variable.dims and variable.dtype.kind in "if" and "x" not in variable.dims
    ]


def all_steps(data: Dataset) -> list[Table]:
    """Return the numbers of each load step: the result, the shape of the contact, the effort."""
    names, of_contact = _names_of_numbers(data), names_of("contact")
    effort = [n for n in names if _is_effort(n)]
    shape = [n for n in names if n in of_contact and _is_shown(data, n)]
    measures = [n for n in names if n not in (*effort, *of_contact) and _is_shown(data, n)]
    tables = {
        "Results of each load step.": measures,
        "Shape of the contact in each load step.": shape,
        "Residuals and effort of each load step.": effort,
    }
    return [steps(data, [*names, "status"], caption) for caption, names in tables.items() if names]


def main_steps(data: Dataset) -> Table:
    """Return the main numbers of each load step, with what was asked for."""
    if has_load(data):
        under_load = dict.fromkeys(["time", prescribed_variable(data), *_OF_LOAD])
        return steps(data, [*(name for name in under_load if name in data), "status"])
    areas = [str(name) for name in data.data_vars if str(name).startswith("contact_area")]
    usual = {"time", "depth", "force", *areas, *names_of("other")}
    named = prescribed_variable(data), "stiffness"
    requested = [name for name in named if name in {*data} - usual]
    time = ["time"] if "time" in data else []
    return steps(data, [*time, "depth", "force", *areas, *requested, "iterations", "status"])


def contact(data: Dataset) -> Table:
    """Return the shape of the contact in each load step, and of the zone around it.

    Under a load it is that of the surface.
    """
    kinds = names_of("contact", "interaction", "load")
    names = [name for name in kinds if name in data and means_something(data, name)]
    return steps(data, [name for name in names if not name.startswith("residual_")])


def path(data: Dataset, *, si: bool = False, whole: bool = True) -> list[Table]:
    """Return the events on the path and its work, where there is an interaction.

    Without the ``whole`` these are pull-off, loss and gain of contact, and the work. Depths,
    forces and stiffnesses have the prefix of those of the load steps.
    """
    of_steps = [data[name] for name in ("depth", "force", "stiffness") if name in data]
    beside = {variable.attrs.get("units"): variable.values.tolist() for variable in of_steps}
    rows = []
    for name, number in path_variables(data).items():
        variable = VARIABLES[name]
        if variable.kind == "path" and (whole or name in _OF_PATH):
            values = [number, *beside.get(variable.unit, ())]
            scale, digits = Column("", values, variable.unit).unit_and_digits(si=si)
            text = "none" if number != number else scale.text(number, digits)
            rows.append((variable.words, text, variable.meaning))
    caption = "Events on the path, to a step, and its work."
    return [Table.of_rows(("path", "value", "meaning"), rows, caption)] if rows else []


def oscillations(data: Dataset) -> list[Table]:
    """Return the numbers of each oscillation on the path, where a leg oscillates."""
    found = oscillations_of(data)
    columns = [
        Column(
            variable.words,
            [getattr(oscillation, variable.name) for oscillation in found],
            variable.unit,
            variable.meaning,
        )
        for variable in map(VARIABLES.__getitem__, names_of("oscillation"))
    ]
    caption = "Response over the last whole cycle of each oscillation."
    return [Table(columns, caption)] if found else []


def runs(table: Dataset, names: Sequence[str] | None = None, mapped: Sequence[int] = ()) -> Table:
    """Return the parameters of each run of a study, and numbers of its last step.

    Without ``names`` these are all but those of the effort. ``mapped`` has the indices of the runs
    that a page maps, in the order of their maps.
    """
    if names is None:
        names = [n for n in _names_of_numbers(table) if not _is_effort(n) and _is_shown(table, n)]
    rows = list(runs_of(table))
    progress = [progress_of(row) for row in rows]

    def last(name: str) -> Column:
        ends = [
            row[name].values[done - 1].item() if done else ""
            for row, (done, *_) in zip(rows, progress, strict=True)
        ]
        return replace(column_of(table[name]), values=ends)

    number = Column(
        "run",
        range(1, len(rows) + 1),
        meaning="number of the run, the last axis varying fastest",
        frames=[mapped.index(index) if index in mapped else None for index in range(len(rows))],
    )
    steps = [f"{done}/{planned}" for done, planned, _ in progress]
    beginning = "beginning of the name of its file in the folder runs"
    columns = [
        number,
        *_of_runs(table, axes_of(table)),
        Column("steps", steps, meaning="finished load steps, of those planned"),
        *map(last, names),
        _verdicts([verdict for *_, verdict in progress]),
        Column("file", short_files(table), meaning=beginning),
    ]
    return Table(columns, "The last load step of each run; a click on a run shows its map.")


def main_runs(table: Dataset) -> Table:
    """Return the parameters of each run of a study, and the main numbers of its last step."""
    named = dict.fromkeys([*names_of("main"), *_OF_LOAD]) if has_load(table) else names_of("main")
    main = [n for n in named if n in table and means_something(table, n)]
    derived = [n for n in json.loads(table.attrs[DERIVED]) if "step" in table[n].dims]
    return runs(table, [*main, *derived])


def paths_of_runs(table: Dataset, names: Sequence[str] | None = None) -> list[Table]:
    """Return numbers of the path of each run, where it sticks or oscillates.

    Without ``names`` these are all of them, and the parameters of the runs.
    """
    if names is None:
        variables = table.data_vars.items()
        per_run = [n for n, v in variables if "step" not in v.dims and v.dtype.kind == "f"]
        names = [*axes_of(table), *map(str, per_run)] if per_run else []
    caption = "The path of each run: events, to a step, and work; the last oscillation."
    number = Column("run", range(1, table["run"].size + 1))
    return [Table([number, *_of_runs(table, names)], caption)] if names else []


def main_paths(table: Dataset) -> list[Table]:
    """Return the main numbers of the path of each run, and those that are derived from them."""
    derived = [n for n in json.loads(table.attrs[DERIVED]) if "step" not in table[n].dims]
    return paths_of_runs(table, [name for name in (*_OF_PATHS, *derived) if name in table])


def _of_runs(table: Dataset, names: Iterable[str]) -> Iterator[Column]:
    for name in names:
        values = table[name].broadcast_like(table["run"]).transpose(*table["run"].dims)
        yield replace(column_of(table[name]), values=column_of(values).values)


def inputs(fields: Iterable[FieldRow], caption: str = "") -> Table:
    """Return each value of a configuration with its meaning, without the title."""
    rows = [
        (i.part, "type" if i.words == i.part else i.words, i.value, i.meaning)
        for i in fields
        if i.name != "title"
    ]
    return Table.of_rows(("of", "input", "value", "meaning"), rows, caption)


def input_table(
    configuration: Mapping[str, Any], model: type[BaseModel], caption: str = ""
) -> Table:
    """Return each value of a configuration of a ``model`` with its meaning, in words and units.

    ``configuration`` has the form of its JSON.
    """
    return inputs(describe.inputs(configuration, model), caption)


def inputs_of_run(configuration: Mapping[str, Any], study: Dataset | None = None) -> Table:
    """Return the inputs of a run, in the form of its JSON, but those of outputs.

    Of a study, whose table is given, they are its axes, and the inputs of its first run that do not
    vary.
    """
    rows: Iterable[FieldRow] = describe.inputs(configuration, Run)
    if study is not None:
        rows = inputs_of_study(study, rows)
    caption = "All inputs that determine the result, defaults included."
    return inputs((row for row in rows if not row.name.startswith("outputs.")), caption)


def inputs_of_study(table: Dataset, fields: Iterable[FieldRow]) -> list[FieldRow]:
    """Return the inputs of a study: its axes, and the inputs of its first run that do not vary."""
    axes = []
    for name in axes_of(table):
        axis = column_of(table[name])
        meaning = f"varied, {len(axis.values)} values"
        axes.append(FieldRow(name, "study", axis.words, axis.listing, meaning))
    names = tuple(f"{axis.name}." for axis in axes)
    return [*axes, *(field for field in fields if not f"{field.name}.".startswith(names))]


def origin(attributes: Mapping[str, Any], configuration: Mapping[str, Any]) -> list[Table]:
    """Return the versions, date and identity of a result, and the packages of its components."""
    facts = [(n, attributes[n]) for n in ("versions", "date", "identity") if attributes.get(n)]
    rows = [
        (i.words, i.value, i.origin.distribution, i.origin.version, i.origin.entry_point)
        for i in describe.inputs(configuration, Run)
        if i.origin
    ]
    heads = "used as", "type", "package", "version", "entry point"
    return [
        Table.of_rows(("what", "value"), facts, "Versions, date and identity."),
        Table.of_rows(heads, rows, "Origin of the components."),
    ]


def planned(tasks: Sequence[RunTask]) -> tuple[Table, str]:
    """Return a row for each run, finished or not, and a sentence on all."""
    rows, done = [], 0
    for task in tasks:
        _, finished, problem = task.stored()
        done += finished >= task.steps
        nx, ny = task.run.grid.points
        state = f"{finished} of {task.steps} steps done" if finished < task.steps else "done"
        rows.append(
            (
                task.name,
                str(task.journal.path),
                f"{nx} × {ny}",
                " × ".join(readable(edge, "m", 3) for edge in task.run.grid.size),
                str(task.steps),
                f"{task.memory / 1e6:.3g} MB",
                problem or (state if finished else "to do"),
            )
        )
    most = max(task.memory for task in tasks) / 1e6
    sentence = (
        f"{len(tasks)} run{'s' * (len(tasks) > 1)}, {done} done, "
        f"{len(tasks) - done} to do; at most {most:.3g} MB each"
    )
    heads = "run", "file", "points", "size", "steps", "memory", "state"
    return Table.of_rows(heads, rows), sentence


def verdicts(cases: Iterable[CheckedCase]) -> Table:
    """Return expected and computed values, with digits to compare, in the unit of the expected."""
    rows = []
    for checked in cases:
        case = checked.case
        scale = axis_unit(case.expected, case.unit.translate(_POWERS))
        values = (scale.text(value, _COMPARED) for value in (case.expected, checked.computed))
        verdict = "ok" if checked.passed else f"FAILED {checked.problem}".strip()
        errors = f"{checked.error:.1e}", f"{case.tolerance:.0e}"
        rows.append((case.name, *values, *errors, verdict, case.source))
    heads = "case", "expected", "computed", "error", "allowed", "verdict", "source"
    return Table.of_rows(heads, rows)
