"""Tables of the web page of a run or a study."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle import Run
from pellicle.config.describe import FieldRow, inputs
from pellicle.contact.caveats import from_text, verdict_of
from pellicle.results.result import Result
from pellicle.results.wording import Wording, means_something, wording, wording_of
from pellicle.show.html import Cell, Column, Table
from pellicle.studies.summary import progress_of, short_files
from pellicle.units import DIGITS, readable
from pellicle.variables import CAVEATS, VARIABLES, names_of

if TYPE_CHECKING:
    import xarray as xr


def _column(variable: xr.DataArray) -> tuple[Column, Wording]:
    """Return the head of a variable's column, and how its values are shown."""
    shown = wording(variable)
    is_text = variable.dtype.kind not in "if"
    meaning = variable.attrs.get("long_name", "")
    return Column(shown.words, shown.scale.unit, meaning, is_text), shown


def path_tables(result: Result) -> list[Table]:
    """Return the numbers of the whole path, where there is an interaction."""
    rows = [
        [VARIABLES[n].words, readable(value, VARIABLES[n].unit, DIGITS), VARIABLES[n].meaning]
        for n, value in result.path_summary.items()
        if n in names_of("path")
    ]
    columns = [Column(head, words=True) for head in ("path", "value", "meaning")]
    caption = "Events on the path, to a step, and its work."
    return [Table(caption, columns, rows)] if rows else []


def oscillation_tables(result: Result) -> list[Table]:
    """Return the numbers of each oscillation, where a leg oscillates."""
    oscillations, columns, cells = result.oscillations, [], []
    for name in names_of("oscillation"):
        values = [getattr(oscillation, name) for oscillation in oscillations]
        shown = wording_of(name, values)
        columns.append(Column(shown.words, shown.scale.unit, VARIABLES[name].meaning))
        cells.append([shown.number(value) for value in values])
    rows = list(zip(*cells, strict=True))
    caption = "Response over the last whole cycle of each oscillation."
    return [Table(caption, columns, rows)] if rows else []


def study_path_tables(table: xr.Dataset, runs: list[xr.Dataset]) -> list[Table]:
    """Return the numbers of the path of each run, where there is an interaction or oscillation."""
    names = [
        str(name)
        for name, variable in table.data_vars.items()
        if "step" not in variable.dims and variable.dtype.kind == "f"
    ]
    if not names:
        return []
    axes = [str(name) for name in table.coords if name != "step"]
    columns = [(name, *_column(table[name])) for name in (*axes, *names)]
    rows = [
        [str(number), *(shown.number(run[name].item()) for name, _, shown in columns)]
        for number, run in enumerate(runs, start=1)
    ]
    heads = [Column("run"), *(column for _, column, _ in columns)]
    caption = "The path of each run: events, to a step, and work; the last oscillation."
    return [Table(caption, heads, rows)]


def names_of_numbers(data: xr.Dataset) -> list[str]:
    """Return the variables that have one number for each step."""
    return [
        str(name)
        for name, variable in data.data_vars.items()
        if "step" in variable.dims and variable.dtype.kind in "if" and "x" not in variable.dims
    ]


def _is_shown(data: xr.Dataset, name: str) -> bool:
    """Return whether a variable describes the contact, and has finite values.

    Without a finite force the variables of a step stay in the table.
    """
    if not means_something(data, name):
        return False
    missing = not np.isfinite(data[name].values.astype(float)).any()
    return not missing or not np.isfinite(data["force"].values).any()


def _is_effort(name: str) -> bool:
    # Prescriptions add residuals of their own.
    return name in names_of("effort") or name.startswith("residual_")


def step_tables(data: xr.Dataset) -> list[Table]:
    """Return the numbers of each load step: the result, the shape of the contact, the effort."""
    numbers, of_contact = names_of_numbers(data), names_of("contact")
    effort = [n for n in numbers if _is_effort(n)]
    shape = [n for n in numbers if n in of_contact and _is_shown(data, n)]
    measures = [n for n in numbers if n not in (*effort, *of_contact) and _is_shown(data, n)]
    tables = {
        "Results of each load step.": measures,
        "Shape of the contact in each load step.": shape,
        "Residuals and effort of each load step.": effort,
    }
    return [_table_of_steps(data, names, caption) for caption, names in tables.items() if names]


def _table_of_steps(data: xr.Dataset, names: list[str], caption: str) -> Table:
    columns, texts = [Column("step")], [list(map(str, data["step"].values))]
    for name in names:
        column, shown = _column(data[name])
        columns.append(column)
        if name.startswith("residual_"):
            shown = replace(shown, digits=2)
        texts.append([shown.number(value) for value in data[name].values.tolist()])
    rows = [
        [*cells, _verdict(verdict_of(from_text(caveats)))]
        for *cells, caveats in zip(*texts, data[CAVEATS].values, strict=True)
    ]
    return Table(caption, [*columns, Column("status", words=True)], rows)


def _verdict(word: str) -> Cell:
    return Cell(word, bad=word != "converged")


def run_table(table: xr.Dataset, runs: list[xr.Dataset], mapped: list[int]) -> Table:
    """Return a row for each run: its values on the axes, and the numbers of its last step.

    ``mapped`` has the indices of the runs that are mapped, in the order of their maps.
    """
    axes = [str(name) for name in table.coords if name != "step"]
    names = [n for n in names_of_numbers(table) if not _is_effort(n) and _is_shown(table, n)]
    heads = {name: _column(table[name]) for name in (*axes, *names)}
    rows: list[list[str | Cell]] = []
    for index, (row, file) in enumerate(zip(runs, short_files(table), strict=True)):
        done, total, word = progress_of(row)
        point = [heads[n][1].number(row[n].item()) for n in axes]
        last = [heads[n][1].number(row[n].values[done - 1].item()) if done else "" for n in names]
        run = Cell(str(index + 1), frame=mapped.index(index) if index in mapped else None)
        rows.append([run, *point, f"{done}/{total}", *last, _verdict(word), file])
    columns = [
        Column("run", meaning="number of the run, the last axis varying fastest"),
        *(heads[name][0] for name in axes),
        Column("steps", meaning="finished load steps, of those planned"),
        *(heads[name][0] for name in names),
        Column("status", words=True),
        Column("file", meaning="beginning of the name of its file in the folder runs", words=True),
    ]
    caption = "The last load step of each run; a click on a run shows its map."
    return Table(caption, columns, rows)


def input_table(fields: list[FieldRow]) -> Table:
    """Return a row for each input."""
    columns = [Column(head, words=True) for head in ("of", "input", "value", "meaning")]
    rows = [
        [i.part, "type" if i.words == i.part else i.words, _shortened(i.value), i.meaning]
        for i in fields
        if i.name != "title" and not i.name.startswith("outputs.")
    ]
    return Table("All inputs that determine the result, defaults included.", columns, rows)


def _shortened(text: str) -> str:
    """Return a text with the first eight digits of hashes."""
    return re.sub(r"\b([0-9a-f]{8})[0-9a-f]{24,}\b", r"\1…", text)


def inputs_of_study(table: xr.Dataset, fields: list[FieldRow]) -> list[FieldRow]:
    """Return the inputs of a study: its axes, and the inputs of its first run that do not vary."""
    axes = []
    for name, axis in table.coords.items():
        if name != "step":
            shown, meaning = wording(axis), f"varied, {axis.size} values"
            values = shown.listing(axis.values.tolist())
            axes.append(FieldRow(str(name), "study", shown.words, values, meaning))
    names = tuple(f"{axis.name}." for axis in axes)
    fixed = [field for field in fields if not f"{field.name}.".startswith(names)]
    return [*axes, *fixed]


def origin_tables(attributes: dict[str, str], configuration: dict[str, Any]) -> Iterator[Table]:
    """Yield the versions, date and identity of a result, and the packages of its components."""
    facts = [
        ("versions", attributes["versions"]),
        ("date", attributes["date"]),
        ("identity", _shortened(attributes.get("identity", ""))),
    ]
    heads = [Column("what", words=True), Column("value", words=True)]
    yield Table("Versions, date and identity.", heads, [list(fact) for fact in facts if fact[1]])
    rows = [
        [i.words, i.value, i.origin.distribution, i.origin.version, i.origin.entry_point]
        for i in inputs(configuration, Run)
        if i.origin
    ]
    names = ("used as", "type", "package", "version", "entry point")
    yield Table("Origin of the components.", [Column(n, words=True) for n in names], rows)
