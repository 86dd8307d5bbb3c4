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
    requested = [name for name in names_of("requested") if name in data]
    if "contact_radius" in result.configuration["loading"]:
        requested.insert(0, "contact_radius")
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
    """Print the shape of the contact at each step."""
    from pellicle.results.variables import names_of

    data = result.dataset
    # Files of earlier versions lack them.
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
    """Print parameters, last step and verdict of each run of a study."""
    from pellicle.studies.summary import rows

    lines = rows(table)
    names = list(lines[0])
    print_table(names, lines, _heads(table, [name for name in names if name in table]))


def exit_by_convergence(result: Result) -> None:
    """Print which steps did not converge or are too coarse; exit unless all converged."""
    from pellicle.results.result import said_of_steps

    for step, message in result.failures():
        typer.echo(f"step {step} did not converge: {for_document(message)}", err=True)
    if coarse := result.coarse():
        print_warning(said_of_steps(coarse))
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
