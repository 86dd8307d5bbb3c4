"""Print results and tables of studies, and exit by how they converged.

Commands import it when they are called: unlike them it imports what it needs at once.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import typer
import xarray as xr

from pellicle.contact.caveats import Status, from_text, verdict_of
from pellicle.files import for_document
from pellicle.results.path import prescribed_variable
from pellicle.results.result import Result
from pellicle.results.wording import means_something, wording, wording_of
from pellicle.studies import summary
from pellicle.units import DIGITS, Scale, printed, readable
from pellicle.variables import CAVEATS, VARIABLES, names_of

from .printing import NOT_CONVERGED, echo, print_columns, print_json, print_warning


def print_origin(data: xr.Dataset) -> None:
    """Print title, date and versions of a result."""
    for name in ("title", "date", "versions"):
        echo(f"{name + ':':10}{for_document(str(data.attrs.get(name, '')))}")


def print_steps(result: Result, *, si: bool = False) -> None:
    """Print a row for each step."""
    data = result.dataset
    areas = [str(name) for name in data.data_vars if str(name).startswith("contact_area")]
    printed_names = {"time", "depth", "force", *areas, *names_of("other")}
    named = prescribed_variable(data), "stiffness"
    requested = [name for name in named if name in {*data} - printed_names]
    time = ["time"] if "time" in data else []
    names = [*time, "depth", "force", *areas, *requested, "iterations"]
    verdicts = [verdict_of(from_text(text)) for text in data[CAVEATS].values]
    print_columns([*_columns(data, names, si), ("status", verdicts)])


def print_contact(result: Result, *, si: bool = False) -> None:
    """Print the shape of the contact at each step, and of the zone around it."""
    data = result.dataset
    # Files of earlier versions lack some.
    names = [name for name in names_of("contact", "interaction") if name in data]
    names = [name for name in names if means_something(data, name)]
    if names := [name for name in names if not name.startswith("residual_")]:
        print_columns(_columns(data, names, si), "contact")


def print_path(result: Result, *, si: bool = False) -> None:
    """Print the events on the path and its work, where there is an interaction."""

    def value(number: float, unit: str) -> str:
        text = Scale(1.0, printed(unit)).text(number, 6) if si else readable(number, unit, DIGITS)
        return "none" if number != number else text

    events = names_of("path")
    numbers = result.path_summary.items()
    rows = [(VARIABLES[name], number) for name, number in numbers if name in events]
    if rows:
        names = "path", [variable.words for variable, _ in rows]
        values = "value", [value(number, variable.unit) for variable, number in rows]
        print_columns([names, values, ("meaning", [variable.meaning for variable, _ in rows])])


def print_oscillations(result: Result, *, si: bool = False) -> None:
    """Print a row for each oscillation on the path."""
    if oscillations := result.oscillations:
        table = []
        for name in names_of("oscillation"):
            values = [getattr(oscillation, name) for oscillation in oscillations]
            column = wording_of(name, values, si=si)
            table.append((column.head, [column.number(value) for value in values]))
        print_columns(table, "oscillations")


def _columns(data: xr.Dataset, names: Sequence[str], si: bool) -> list[tuple[str, list[str]]]:
    """Return head and cells of the steps and of variables."""
    table = [("step", [str(number) for number in data["step"].values.tolist()])]
    for name in names:
        column = wording(data[name], si=si)
        table.append((column.head, [column.number(v) for v in data[name].values.tolist()]))
    return table


def print_runs(table: xr.Dataset, *, si: bool = False) -> None:
    """Print parameters, last step and verdict of each run of a study, and its path."""
    print_columns(summary.columns(table, si=si))
    print_columns(summary.path_columns(table, si=si), "path")


def print_result_json(result: Result, files: Sequence[Path] = ()) -> None:
    """Print a result as JSON: its origin, and the numbers of each step in SI."""
    data, planned = result.dataset, result.planned_steps
    converged = result.converged and data.sizes["step"] == planned
    steps, path = _steps(data), result.path_summary
    _print_json(data, files, converged=converged, planned_steps=planned, steps=steps, path=path)


def print_study_json(table: xr.Dataset, files: Sequence[Path] = ()) -> None:
    """Print a study as JSON: its origin, and the numbers of each step of each run in SI."""
    runs = []
    for run in summary.runs_of(table):
        done, planned, verdict = summary.progress_of(run)
        axes = {str(n): value.item() for n, value in run.coords.items() if n != "step"}
        per_run = {
            str(name): variable.item()
            for name, variable in run.data_vars.items()
            if not variable.dims and name != "run"
        }
        runs.append(
            {
                "file": f"runs/{run['run'].item()}.h5",
                "parameters": axes,
                "converged": verdict == "converged" and done == planned,
                "planned_steps": planned,
                "steps": _steps(run.isel(step=slice(planned))),
                "path": per_run,
            }
        )
    _print_json(table, files, converged=all(run["converged"] for run in runs), runs=runs)


def _print_json(data: xr.Dataset, files: Sequence[Path], **own: object) -> None:
    origin = {name: data.attrs.get(name, "") for name in ("title", "date", "versions")}
    units = {
        name: variable.attrs["units"]
        for name, variable in data.variables.items()
        if variable.attrs.get("units", "1") != "1"
    }
    print_json({**origin, **own, "units": units, "files": list(map(str, files))})


def _steps(data: xr.Dataset) -> list[dict[str, Any]]:
    """Return the numbers and texts of each step by name."""
    names = [
        "step",
        *(str(n) for n, variable in data.data_vars.items() if variable.dims == ("step",)),
    ]
    columns = [data[name].values.tolist() for name in names]
    steps = [dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True)]
    return [step | {CAVEATS: json.loads(step[CAVEATS] or "[]")} for step in steps]


def exit_by_convergence(result: Result) -> None:
    """Print which steps did not converge, or have a caveat; exit unless all converged."""
    failed: dict[Status, list[tuple[int, str]]] = {}
    for number, caveat in result.caveats():
        if not caveat.status.converged:
            failed.setdefault(caveat.status, []).append((number, caveat.sentence))
    for group in failed.values():
        steps = _steps_text([number for number, _ in group])
        several = len({message for _, message in group}) > 1
        first = f"step {group[0][0]}: " if several else ""
        echo(f"{steps} did not converge: {first}{for_document(group[0][1])}", err=True)
    for message in result.warnings():
        print_warning(message)
    if not result.converged:
        raise typer.Exit(NOT_CONVERGED)


def _steps_text(numbers: Sequence[int]) -> str:
    """Return "step 3", "steps 1 and 2" or "steps 1, 3 to 5"."""
    spans: list[list[int]] = []
    for number in numbers:
        if spans and number == spans[-1][-1] + 1:
            spans[-1].append(number)
        else:
            spans.append([number])
    texts = [str(s[0]) if len(s) == 1 else f"{s[0]} to {s[-1]}" for s in spans]
    if len(numbers) == 2:
        texts = [f"{numbers[0]} and {numbers[1]}"]
    return f"step{'s' * (len(numbers) > 1)} {', '.join(texts)}"


def exit_by_status(table: xr.Dataset) -> None:
    """Print which runs of a study did not converge; exit unless all did."""
    if message := summary.failures(table):
        for reason in summary.reasons(table):
            echo(for_document(reason), err=True)
        echo(message, err=True)
        raise typer.Exit(NOT_CONVERGED)
