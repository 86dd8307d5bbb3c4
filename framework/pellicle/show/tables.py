"""The tables of studies and of inputs: for the terminal, pages, notebooks and files alike."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from pellicle.arrays import Dataset
from pellicle.components.charts import Column, Table
from pellicle.config import describe
from pellicle.config.describe import FieldRow
from pellicle.config.run import Run
from pellicle.results.derived import DERIVED
from pellicle.results.path import has_load
from pellicle.results.runs import axes_of, progress_of, runs_of, short_files
from pellicle.results.step_tables import (
    OF_LOAD,
    is_effort,
    is_shown,
    names_of_numbers,
    verdicts_column,
)
from pellicle.results.step_tables import all_steps as all_steps
from pellicle.results.step_tables import main_steps as main_steps
from pellicle.results.step_tables import numbers as numbers
from pellicle.results.step_tables import oscillations as oscillations
from pellicle.results.step_tables import path as path
from pellicle.results.wording import column_of, has_meaning
from pellicle.units import axis_unit, readable
from pellicle.variables import names_of

if TYPE_CHECKING:
    from pydantic import BaseModel

    from pellicle.runs.validation import CheckedCase
    from pellicle.studies.runner import RunTask

_OF_PATHS = [
    *("pull_off", "pull_off_accuracy", "detach", "jump_in", "dissipated_energy"),
    *("storage_stiffness", "loss_stiffness", "phase", "cycle_dissipation"),
]
"""Variables of the path of each run of a study, for the terminal."""
_COMPARED = 8
"""Digits of values that are compared."""
_POWERS = str.maketrans("²³", "23")


def runs(table: Dataset, names: Sequence[str] | None = None, mapped: Sequence[int] = ()) -> Table:
    """Return the parameters of each run of a study, and numbers of its last step.

    Without ``names`` these are all but those of the effort. ``mapped`` has the indices of the runs
    that a page maps, in the order of their maps.
    """
    if names is None:
        names = [n for n in names_of_numbers(table) if not is_effort(n) and is_shown(table, n)]
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
        verdicts_column([verdict for *_, verdict in progress]),
        Column("file", short_files(table), meaning=beginning),
    ]
    return Table(columns, "The last load step of each run; a click on a run shows its map.")


def main_runs(table: Dataset) -> Table:
    """Return the parameters of each run of a study, and the main numbers of its last step."""
    named = dict.fromkeys([*names_of("main"), *OF_LOAD]) if has_load(table) else names_of("main")
    main = [n for n in named if n in table and has_meaning(table, n)]
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


def input_table(
    configuration: Mapping[str, Any], model: type[BaseModel], caption: str = ""
) -> Table:
    """Return each value of a configuration of a ``model`` with its meaning, in words and units.

    ``configuration`` has the form of its JSON.
    """
    return describe.table_of(describe.inputs(configuration, model), caption)


def inputs_of_run(configuration: Mapping[str, Any], study: Dataset | None = None) -> Table:
    """Return the inputs of a run, in the form of its JSON, but those of outputs.

    Of a study, whose table is given, they are its axes, and the inputs of its first run that do not
    vary.
    """
    rows: Iterable[FieldRow] = describe.inputs(configuration, Run)
    if study is not None:
        rows = inputs_of_study(study, rows)
    caption = "All inputs that determine the result, defaults included."
    return describe.table_of((row for row in rows if not row.name.startswith("outputs.")), caption)


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


def plan_table(tasks: Sequence[RunTask]) -> tuple[Table, str]:
    """Return a row for each run, finished or not, and a sentence on all."""
    rows, done = [], 0
    for task in tasks:
        _, finished, problem = task.read_steps()
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
