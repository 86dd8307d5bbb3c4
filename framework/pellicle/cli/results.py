"""What is printed of results and of studies, and the exit code that they deserve."""

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
    """Print where a result comes from."""
    for name in ("title", "date", "versions"):
        typer.echo(f"{name + ':':10}{for_document(str(data.attrs.get(name, '')))}")


def print_steps(result: Result) -> None:
    """Print a row for each step."""
    from pellicle.results.variables import names_of

    data = result.dataset
    areas = [str(name) for name in data.data_vars if str(name).startswith("contact_area")]
    shown = {"depth", "force", *areas, *names_of("other")}
    loading = [name for name in result.configuration["loading"] if name in data]
    requested = [name for name in (*loading, "stiffness") if name in {*data} - shown]
    requested = [*dict.fromkeys(reversed(requested))][::-1]
    names = ["depth", "force", *areas, *requested, "iterations"]
    coarse = dict(result.coarse())
    rows = []
    for number in data["step"].values.tolist():
        step = data.sel(step=number)
        row = {name: f"{step[name].item():.6g}" for name in names}
        status = "converged" if step["converged"].item() else "NOT CONVERGED"
        if number in coarse:
            status = "too coarse"
        rows.append({"step": str(number), **row, "status": status})
    print_table(["step", *names, "status"], rows, _heads(data, names))
    for number, converged, status in zip(
        data["step"].values.tolist(), data["converged"], data["status"], strict=True
    ):
        if converged and status != "converged" and number not in coarse:
            typer.echo(f"step {number}: {for_document(str(status.item()))}", err=True)


def print_contact(result: Result) -> None:
    """Print a second table, of the shape of the contact."""
    from pellicle.results.variables import names_of

    data = result.dataset
    # Files of earlier versions do not say it.
    names = [name for name in names_of("contact") if name in data]
    if not names:
        return
    typer.echo("contact:")
    rows = [
        {"step": str(number), **{name: f"{data[name].values[index]:.6g}" for name in names}}
        for index, number in enumerate(data["step"].values.tolist())
    ]
    print_table(["step", *names], rows, _heads(data, names))


def _heads(data: xr.Dataset, names: list[str]) -> dict[str, str]:
    from pellicle.results.variables import header

    return {name: header(name, data[name]) for name in names}


def print_runs(table: xr.Dataset) -> None:
    """Print a row for each run of a study: its parameters, its last step and how it ended."""
    from pellicle.studies.summary import rows

    found = rows(table)
    names = list(found[0])
    units = {name: table[name].attrs.get("units", "1") for name in names if name in table}
    heads = {name: f"{name} [{unit}]" for name, unit in units.items() if unit != "1"}
    print_table(names, found, heads)


def exit_by_convergence(result: Result) -> None:
    """Exit unless all steps of a run converged, and say which did not or are too coarse."""
    from pellicle.results.result import said_of_steps

    for step, message in result.failures():
        typer.echo(f"step {step} did not converge: {for_document(message)}", err=True)
    if coarse := result.coarse():
        print_warning(said_of_steps(coarse))
    if not result.converged:
        raise typer.Exit(NOT_CONVERGED)


def exit_by_status(table: xr.Dataset) -> None:
    """Exit unless all runs of a study converged, and say which did not."""
    from pellicle.studies.summary import failures, reasons

    if message := failures(table):
        for reason in reasons(table):
            typer.echo(for_document(reason), err=True)
        typer.echo(message, err=True)
        raise typer.Exit(NOT_CONVERGED)
