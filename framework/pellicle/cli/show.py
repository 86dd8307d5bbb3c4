"""``pellicle show``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .exits import NOT_CONVERGED
from .results import (
    exit_by_convergence,
    exit_by_status,
    print_contact,
    print_origin,
    print_oscillations,
    print_path,
    print_runs,
    print_steps,
)


def show(
    results: Annotated[
        Path, typer.Argument(help="Result file (.h5), or the folder or study.h5 of a study.")
    ],
) -> None:
    """Print the steps of a result, or the runs of a study, and its origin."""
    from pellicle.results.result import load
    from pellicle.studies.runner import is_table, read
    from pellicle.studies.summary import caveats

    if is_table(results):
        table, _ = read(results)
        print_origin(table)
        print_runs(table)
        for message in caveats(table):
            typer.echo(message, err=True)
        exit_by_status(table)
        return
    result = load(results)
    print_origin(result.dataset)
    total, done = result.planned_steps, result.dataset.sizes["step"]
    print_steps(result)
    print_contact(result)
    print_path(result)
    print_oscillations(result)
    exit_by_convergence(result)
    if done < total:
        typer.echo(f"interrupted: {done} of {total} steps are finished; run it again", err=True)
        raise typer.Exit(NOT_CONVERGED)
