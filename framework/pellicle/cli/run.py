"""``pellicle run``."""

from __future__ import annotations

from pathlib import Path
from time import monotonic
from typing import Annotated, Any

import typer

from pellicle.plugins.hooks import RegisterCommand, hookimpl

from .printing import INTERRUPTED, AsJSON, InSI, echo, print_json, print_table


def run(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="TOML file (`pellicle new` writes one).")
    ],
    directory: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            help="Folder for the results (default: FILE's name without .toml).",
        ),
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="KEY=VALUE", help='Replace a value: --set kernel.tension="5 mN/m".'
        ),
    ] = None,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="Print errors and warnings only.")
    ] = False,
    threads: Annotated[
        int | None,
        typer.Option(
            min=1,
            metavar="N",
            help="Threads of arrays and transforms (default: the fastest number).",
        ),
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Start over and replace an existing result.")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Print the planned runs without executing them.")
    ] = False,
    si: InSI = False,
    json: AsJSON = False,
) -> None:
    """Solve a run, or all runs of a study, and write the results; continue after an interruption.

    Exit code 0 only if every step converged.
    """
    from pellicle.config.study import Study, from_toml
    from pellicle.contact.caveats import Status
    from pellicle.runs import runner
    from pellicle.runs.journal import Journal
    from pellicle.runs.outputs import standard_outputs
    from pellicle.runs.progress import RunProgress
    from pellicle.show import sentences, tables
    from pellicle.studies import runner as studies

    from .results import exit_by_outcome, print_outcome_json, print_tables

    began, configuration = monotonic(), from_toml(file, set_ or ())
    folder = directory or Path(file.stem)
    stem = folder / file.stem
    if dry_run:
        studies.warn_of_scale(configuration)
        tasks = studies.planned(configuration, stem, overwrite=overwrite)
        table, sentence = tables.planned(tasks)
        if json:
            print_json({"runs": table.records})
        else:
            print_table(table)
            echo(sentence)
        return
    outcome: Any
    try:
        if isinstance(configuration, Study):
            whole = f"{len(configuration.points)} runs"
            outcome, files, resumed = studies.execute(
                configuration, folder, progress=not quiet, overwrite=overwrite, threads=threads
            )
        else:
            steps = configuration.steps
            whole, bar = f"{steps} steps", RunProgress(steps, not quiet)
            journal = Journal(stem, configuration.identity, overwrite)
            outputs = standard_outputs(configuration.outputs)
            outcome, files, resumed = runner.execute(
                configuration, journal, outputs, bar, threads=threads
            )
            if any(Status[code].at_edge for code in outcome.dataset["status_code"].values):
                echo(sentences.larger_domain(file, folder), err=True)
    except KeyboardInterrupt:
        finished = "runs" if isinstance(configuration, Study) else "steps"
        echo(sentences.interrupted(finished, folder), err=True)
        raise typer.Exit(INTERRUPTED) from None
    if json:
        print_outcome_json(outcome, files)
    elif not quiet:
        print_tables(outcome, si=si, whole=False)
        for sentence in sentences.done(files, resumed, whole, monotonic() - began):
            echo(sentence)
    exit_by_outcome(outcome)


@hookimpl
def register_commands(register: RegisterCommand) -> None:
    """Register the command."""
    register(run, file="pellicle.config.run:Run")
