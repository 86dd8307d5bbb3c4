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

from pellicle.files import for_document
from pellicle.results.result import Result
from pellicle.results.runs import axes_of, progress_of, runs_of
from pellicle.show import sentences, tables
from pellicle.variables import CAVEATS

from .printing import NOT_CONVERGED, echo, print_json, print_table, print_warning


def print_origin(data: xr.Dataset) -> None:
    """Print title, date and versions of a result."""
    for name in ("title", "date", "versions"):
        echo(f"{name + ':':10}{for_document(str(data.attrs.get(name, '')))}")


def print_result(result: Result, *, si: bool = False) -> None:
    """Print origin, steps, shape of the contact and path of a run."""
    data = result.dataset
    print_origin(data)
    print_table(tables.main_steps(data), si=si)
    print_table(tables.contact(data), "contact", si=si)
    for table in tables.path(data, si=si):
        print_table(table)
    for table in tables.oscillations(data):
        print_table(table, "oscillations", si=si)


def print_runs(table: xr.Dataset, *, si: bool = False) -> None:
    """Print parameters, last step and verdict of each run of a study, and its path."""
    print_table(tables.main_runs(table), si=si)
    for path in tables.main_paths(table):
        print_table(path, "path", si=si)


def print_result_json(result: Result, files: Sequence[Path] = ()) -> None:
    """Print a result as JSON: its origin, and the numbers of each step in SI."""
    data, planned = result.dataset, result.planned_steps
    converged = result.converged and data.sizes["step"] == planned
    steps, path = _steps(data), result.path_summary
    _print_json(data, files, converged=converged, planned_steps=planned, steps=steps, path=path)


def print_study_json(table: xr.Dataset, files: Sequence[Path] = ()) -> None:
    """Print a study as JSON: its origin, and the numbers of each step of each run in SI."""
    runs = []
    for run in runs_of(table):
        done, planned, verdict = progress_of(run)
        axes = {name: run[name].item() for name in axes_of(run)}
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
    rows = tables.numbers(data).records
    return [row | {CAVEATS: json.loads(str(row[CAVEATS]) or "[]")} for row in rows]


def exit_by_convergence(result: Result) -> None:
    """Print which steps did not converge, or have a caveat; exit unless all converged."""
    for sentence in sentences.failed_steps(result):
        echo(for_document(sentence), err=True)
    for message in result.warnings():
        print_warning(message)
    if not result.converged:
        raise typer.Exit(NOT_CONVERGED)


def exit_by_status(table: xr.Dataset) -> None:
    """Print which runs of a study did not converge; exit unless all did."""
    if message := sentences.failures(table):
        for reason in sentences.reasons(table):
            echo(for_document(reason), err=True)
        echo(message, err=True)
        raise typer.Exit(NOT_CONVERGED)
