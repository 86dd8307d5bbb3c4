"""Print results and tables of studies, and exit by how they converged.

Commands import it when they are called: unlike them it imports what it needs at once.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import typer
import xarray as xr

from pellicle.files import for_document
from pellicle.plugins.commands import Command, commands, errors_attributed_to, load_command
from pellicle.plugins.origins import GROUP
from pellicle.results import step_tables, storage
from pellicle.results.path import has_load
from pellicle.results.result import Result
from pellicle.results.runs import axes_of, progress_of, runs_of
from pellicle.results.status import failed_steps
from pellicle.show import sentences, tables
from pellicle.variables import CAVEATS

from .printing import NOT_CONVERGED, echo, print_json, print_table, print_warning


@contextmanager
def command_display(file: Path) -> Iterator[Any]:
    """Yield what shows the table of a command, as `RegisterCommand` says; None for a result."""
    name = str(storage.attributes(file, "any").get("command", ""))
    command = load_command(name) if name in commands() else None
    if not isinstance(command, Command) or not command.written:
        yield None
        return
    with errors_attributed_to(name):
        yield EntryPoint(name, command.written, GROUP).load()(file)


def print_origin(data: xr.Dataset) -> None:
    """Print title, date and versions of a result."""
    for name in ("title", "date", "versions"):
        echo(f"{name + ':':10}{for_document(str(data.attrs.get(name, '')))}")


def print_tables(outcome: Result | xr.Dataset, *, si: bool = False, whole: bool = True) -> None:
    """Print path and steps of a run, with the ``whole`` also its contact; the runs of a study.

    A study is given by its table.
    """
    if isinstance(outcome, xr.Dataset):
        print_table(tables.main_runs(outcome), si=si)
        for path in tables.main_paths(outcome):
            print_table(path, "path", si=si)
        return
    data = outcome.dataset
    for path in step_tables.path(data, si=si, whole=whole):
        print_table(path)
    print_table(step_tables.main_steps(data), si=si)
    if whole:
        print_table(step_tables.contact(data), "surface" if has_load(data) else "contact", si=si)
        for table in step_tables.oscillations(data):
            print_table(table, "oscillations", si=si)


def print_outcome_json(outcome: Result | xr.Dataset, files: Sequence[Path] = ()) -> None:
    """Print a run or a study as JSON: its origin, and the numbers of each step in SI."""
    own: dict[str, Any]
    if isinstance(outcome, Result):
        data, planned = outcome.dataset, outcome.planned_steps
        converged = outcome.converged and data.sizes["step"] == planned
        own = {"converged": converged, "planned_steps": planned, "steps": _steps(data)}
        own["path"] = outcome.path_summary
    else:
        data = outcome
        runs = [*map(_run, runs_of(data))]
        own = {"converged": all(run["converged"] for run in runs), "runs": runs}
    origin = {name: data.attrs.get(name, "") for name in ("title", "date", "versions")}
    units = {
        name: variable.attrs["units"]
        for name, variable in data.variables.items()
        if variable.attrs.get("units", "1") != "1"
    }
    print_json({**origin, **own, "units": units, "files": list(map(str, files))})


def _run(run: xr.Dataset) -> dict[str, Any]:
    done, planned, verdict = progress_of(run)
    per_run = {
        str(name): variable.item()
        for name, variable in run.data_vars.items()
        if not variable.dims and name != "run"
    }
    return {
        "file": f"runs/{run['run'].item()}.h5",
        "parameters": {name: run[name].item() for name in axes_of(run)},
        "converged": verdict == "converged" and done == planned,
        "planned_steps": planned,
        "steps": _steps(run.isel(step=slice(planned))),
        "path": per_run,
    }


def _steps(data: xr.Dataset) -> list[dict[str, Any]]:
    rows = step_tables.numbers(data).records
    return [row | {CAVEATS: json.loads(str(row[CAVEATS]) or "[]")} for row in rows]


def exit_by_outcome(outcome: Result | xr.Dataset) -> None:
    """Print what did not converge, and the caveats of a run; exit unless all converged."""
    if isinstance(outcome, Result):
        reasons, messages = [*failed_steps(outcome)], outcome.warnings()
    else:
        message = sentences.failures(outcome)
        reasons, messages = [*sentences.reasons(outcome), message] if message else [], []
    for reason in reasons:
        echo(for_document(reason), err=True)
    for warning in messages:
        print_warning(warning)
    if reasons:
        raise typer.Exit(NOT_CONVERGED)
