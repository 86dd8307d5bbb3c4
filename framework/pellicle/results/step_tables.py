"""The tables of the load steps of a result: for the terminal, pages, notebooks and files alike.

A table for people holds a list of the variables by name, and ``status``, how each step ended.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from pellicle.arrays import Dataset
from pellicle.components.charts import Column, Table
from pellicle.contact.caveats import from_text, verdict_of
from pellicle.variables import CAVEATS, VARIABLES, names_of

from .path import has_load, oscillations_of, path_variables, prescribed_variable
from .wording import column_of, has_meaning

_OF_PATH = "pull_off", "pull_off_accuracy", "detach", "jump_in", "work", "dissipated_energy"
"""Variables of the path of a run that has just been solved, for the terminal."""
OF_LOAD = "force", "ridge_height", "ridge_width", "dimple_depth", "dimple_volume", "elastic_energy"
"""Variables of each step under a load, for the terminal."""


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
            columns.append(
                verdicts_column([verdict_of(from_text(t)) for t in data[CAVEATS].values])
            )
        else:
            column = column_of(data[name])
            digits = 2 if name.startswith("residual_") else column.digits
            columns.append(replace(column, digits=digits))
    return Table(columns, caption)


def verdicts_column(words: Sequence[str]) -> Column:
    """Return how runs or steps ended, marked where they are not to be relied on."""
    return Column("status", words, bad=[word != "converged" for word in words])


def is_effort(name: str) -> bool:
    """Return whether a variable is one of the effort, or a residual."""
    # Prescriptions add residuals of their own.
    return name in names_of("effort") or name.startswith("residual_")


def is_shown(data: Dataset, name: str) -> bool:
    """Return whether a variable describes the contact, and has finite values.

    Without a finite force the variables of a step stay in the table.
    """
    if not has_meaning(data, name):
        return False
    missing = not np.isfinite(data[name].values.astype(float)).any()
    return not missing or not np.isfinite(data["force"].values).any()


def names_of_numbers(data: Dataset) -> list[str]:
    """Return the names of the numbers of each step."""
    return [
        str(name)
        for name, variable in data.data_vars.items()
        if "step" in variable.dims and variable.dtype.kind in "if" and "x" not in variable.dims
    ]


def all_steps(data: Dataset) -> list[Table]:
    """Return the numbers of each load step: the result, the shape of the contact, the effort."""
    names, of_contact = names_of_numbers(data), names_of("contact")
    effort = [n for n in names if is_effort(n)]
    shape = [n for n in names if n in of_contact and is_shown(data, n)]
    measures = [n for n in names if n not in (*effort, *of_contact) and is_shown(data, n)]
    tables = {
        "Results of each load step.": measures,
        "Shape of the contact in each load step.": shape,
        "Residuals and effort of each load step.": effort,
    }
    return [steps(data, [*names, "status"], caption) for caption, names in tables.items() if names]


def main_steps(data: Dataset) -> Table:
    """Return the main numbers of each load step, with what was asked for."""
    if has_load(data):
        under_load = dict.fromkeys(["time", prescribed_variable(data), *OF_LOAD])
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
    names = [name for name in kinds if name in data and has_meaning(data, name)]
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
    responses = oscillations_of(data)
    columns = [
        Column(
            variable.words,
            [getattr(oscillation, variable.name) for oscillation in responses],
            variable.unit,
            variable.meaning,
        )
        for variable in map(VARIABLES.__getitem__, names_of("oscillation"))
    ]
    caption = "Response over the last whole cycle of each oscillation."
    return [Table(columns, caption)] if responses else []
