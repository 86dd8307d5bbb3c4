"""``pellicle show``."""

from __future__ import annotations

import typer

from .printing import NOT_CONVERGED, AsJSON, InSI, Stored, echo


def show(results: Stored, si: InSI = False, json: AsJSON = False) -> None:
    """Print steps of a result or runs of a study, and its origin; or what a command wrote."""
    from pellicle.results.result import Result, file_of_run, load
    from pellicle.results.status import interruption_note
    from pellicle.show import sentences
    from pellicle.studies.runner import is_table, read

    from .results import (
        command_display,
        exit_by_outcome,
        print_origin,
        print_outcome_json,
        print_tables,
    )

    if not (is_study := is_table(results)):
        with command_display(file_of_run(results)) as of_command:
            if of_command:
                of_command.show(si=si, json=json)
                return
    outcome = read(results)[0] if is_study else load(results)
    if json:
        print_outcome_json(outcome)
    else:
        print_origin(outcome.dataset if isinstance(outcome, Result) else outcome)
        print_tables(outcome, si=si)
    if not isinstance(outcome, Result):
        for message in sentences.caveats(outcome):
            echo(message, err=True)
    exit_by_outcome(outcome)
    if isinstance(outcome, Result) and (message := interruption_note(outcome)):
        echo(message, err=True)
        raise typer.Exit(NOT_CONVERGED)
