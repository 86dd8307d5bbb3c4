"""``pellicle show``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pellicle.commands import errors_attributed_to, usable_commands
from pellicle.errors import StorageError

from .printing import NOT_CONVERGED, echo


def show(
    results: Annotated[
        Path,
        typer.Argument(
            metavar="RESULTS",
            help="Folder of a run, a study or another command; result (.h5) or study.h5.",
        ),
    ],
    si: Annotated[bool, typer.Option("--si", help="Print numbers in SI units.")] = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print the result as JSON, in SI units.")
    ] = False,
) -> None:
    """Print the steps of a result, or the runs of a study, and its origin, or another table."""
    from pellicle.results.result import load
    from pellicle.show.sentences import caveats, unfinished
    from pellicle.studies.runner import is_table, read

    from . import results as prints

    if is_table(results):
        table, _ = read(results)
        if json:
            prints.print_study_json(table)
        else:
            prints.print_origin(table)
            prints.print_runs(table, si=si)
        for message in caveats(table):
            echo(message, err=True)
        prints.exit_by_status(table)
        return
    try:
        result = load(results)
    except StorageError:
        for name, command in usable_commands().items():
            with errors_attributed_to(name):
                if command.show and command.show(results, si, json):
                    return
        raise
    total, done = result.planned_steps, result.dataset.sizes["step"]
    if json:
        prints.print_result_json(result)
    else:
        prints.print_result(result, si=si)
    prints.exit_by_convergence(result)
    if done < total:
        echo(unfinished(done, total), err=True)
        raise typer.Exit(NOT_CONVERGED)
