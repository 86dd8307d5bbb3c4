"""Print results and tables of studies, and exit by how they converged."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from pellicle.files import for_document

from .exits import NOT_CONVERGED
from .printing import print_table, print_warning

if TYPE_CHECKING:
    import xarray as xr

    from pellicle.results.result import Result


def print_origin(data: xr.Dataset) -> None:
    """Print title, date and versions of a result."""
    for name in ("title", "date", "versions"):
        typer.echo(f"{name + ':':10}{for_document(str(data.attrs.get(name, '')))}")


def print_steps(result: Result) -> None:
    """Print a row for each step."""
    from pellicle.results.variables import names_of

    data = result.dataset
    areas = [str(name) for name in data.data_vars if str(name).startswith("contact_area")]
    shown = {"time", "depth", "force", *areas, *names_of("other")}
    loading = [name for name in result.configuration["loading"] if name in data]
    requested = [name for name in (*loading, "stiffness") if name in {*data} - shown]
    requested = [*dict.fromkeys(reversed(requested))][::-1]
    time = ["time"] if "time" in data else []
    names = [*time, "depth", "force", *areas, *requested, "iterations"]
    coarse = dict(result.coarse())
    numbers = data["step"].values.tolist()
    converged = dict(zip(numbers, data["converged"].values.tolist(), strict=True))
    verdicts = [
        "too coarse" if n in coarse else "converged" if converged[n] else "NOT CONVERGED"
        for n in numbers
    ]
    _print_steps(data, names, {"status": verdicts})
    several = {**coarse, **dict(result.steep()), **dict(result.cramped())}
    for number, status in zip(numbers, data["status"].values.tolist(), strict=True):
        if converged[number] and status != "converged" and number not in several:
            typer.echo(f"step {number}: {for_document(status)}", err=True)


def print_contact(result: Result) -> None:
    """Print the shape of the contact at each step, and of the zone around it."""
    from pellicle.results.variables import names_of

    # Files of earlier versions lack them.
    names = [name for name in names_of("contact", "interaction") if name in result.dataset]
    if names := [name for name in names if not name.startswith("residual_")]:
        typer.echo("contact:")
        _print_steps(result.dataset, names, {})


def print_path(result: Result) -> None:
    """Print the events on the path and its work, where there is an interaction."""
    import math

    from pellicle.results.variables import VARIABLES, names_of
    from pellicle.units import readable

    events = names_of("path")
    if summary := {n: value for n, value in result.path_summary.items() if n in events}:
        typer.echo("path:")
        rows = [
            {
                "name": name,
                "value": "none" if math.isnan(value) else readable(value, VARIABLES[name].unit),
                "meaning": VARIABLES[name].meaning,
            }
            for name, value in summary.items()
        ]
        print_table(["name", "value", "meaning"], rows)


def print_oscillations(result: Result) -> None:
    """Print a row for each oscillation on the path."""
    from dataclasses import asdict

    from pellicle.results.variables import VARIABLES, names_of

    if rows := [asdict(oscillation) for oscillation in result.oscillations]:
        typer.echo("oscillations:")
        names = names_of("oscillation")
        units = {name: VARIABLES[name].unit for name in names}
        heads = {name: f"{name} [{unit}]" for name, unit in units.items() if unit != "1"}
        lines = [{name: f"{value:.6g}" for name, value in row.items()} for row in rows]
        print_table(list(names), lines, heads)


def _print_steps(data: xr.Dataset, names: list[str], texts: dict[str, list[str]]) -> None:
    """Print a row for each step: numbers by their names, and further columns of texts."""
    columns = {"step": [str(number) for number in data["step"].values.tolist()]}
    columns |= {name: [f"{value:.6g}" for value in data[name].values] for name in names} | texts
    rows = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    print_table(list(columns), rows, _heads(data, names))


def _heads(data: xr.Dataset, names: list[str]) -> dict[str, str]:
    from pellicle.results.variables import header

    return {name: header(name, data[name]) for name in names}


def print_runs(table: xr.Dataset) -> None:
    """Print parameters, last step and verdict of each run of a study, and its path."""
    from pellicle.studies.summary import paths, rows

    for caption, lines in (("", rows(table)), ("path:", paths(table))):
        if lines:
            if caption:
                typer.echo(caption)
            names = list(lines[0])
            print_table(names, lines, _heads(table, [name for name in names if name in table]))


def exit_by_convergence(result: Result) -> None:
    """Print which steps did not converge, or have a caveat; exit unless all converged."""
    from pellicle.results.result import first_message

    for step, message in result.failures():
        typer.echo(f"step {step} did not converge: {for_document(message)}", err=True)
    for steps in (result.coarse(), result.steep(), result.cramped()):
        if steps:
            print_warning(first_message(steps))
    if not result.converged:
        raise typer.Exit(NOT_CONVERGED)


def exit_by_status(table: xr.Dataset) -> None:
    """Print which runs of a study did not converge; exit unless all did."""
    from pellicle.studies.summary import failures, reasons

    if message := failures(table):
        for reason in reasons(table):
            typer.echo(for_document(reason), err=True)
        typer.echo(message, err=True)
        raise typer.Exit(NOT_CONVERGED)
