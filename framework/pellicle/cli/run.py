"""``pellicle run``."""

from __future__ import annotations

from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from pellicle.plugins.hooks import RegisterCommand, hookimpl

from .printing import (
    INTERRUPTED,
    NOT_CONVERGED,
    AsJSON,
    InPart,
    InSI,
    echo,
    print_json,
    print_table,
)

if TYPE_CHECKING:
    from pellicle.studies.part import PartOutcome


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
    part: InPart = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Print the planned runs without executing them.")
    ] = False,
    si: InSI = False,
    json: AsJSON = False,
) -> None:
    """Solve a run, or all runs of a study, and write the results; continue after an interruption.

    Exit code 0 only if every step converged.
    """
    from pellicle.batch import Part
    from pellicle.config.study import Study, from_toml
    from pellicle.contact.caveats import Status
    from pellicle.errors import ConfigError
    from pellicle.runs import runner
    from pellicle.runs.journal import Journal
    from pellicle.runs.outputs import standard_outputs
    from pellicle.runs.progress import RunProgress
    from pellicle.show import sentences, tables
    from pellicle.studies import runner as studies
    from pellicle.studies.part import PartOutcome, execute_part

    from .results import exit_by_outcome, print_outcome_json, print_tables

    began, configuration = monotonic(), from_toml(file, set_ or ())
    share, folder = Part.of_text(part), directory or Path(file.stem)
    if share and (overwrite or not isinstance(configuration, Study)):
        raise ConfigError(
            "other parts may be at work, so nothing is overwritten; delete the folder to start over"
            if overwrite
            else f"{file} holds one run; parts are of a study, [study.vary] in the file",
            "part",
        )
    stem = folder / file.stem
    if dry_run:
        studies.warn_of_scale(configuration)
        tasks = studies.plan_runs(configuration, stem, overwrite=overwrite)
        table, sentence = tables.plan_table(share.of(tasks) if share else tasks)
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
            keep_on: Any = {"progress": not quiet, "threads": threads}
            if share:
                executed = execute_part(configuration, folder, share, **keep_on)
            else:
                executed = studies.execute(configuration, folder, overwrite=overwrite, **keep_on)
            if isinstance(executed, PartOutcome):
                _exit_by_part(executed, whole, json=json, quiet=quiet)
            outcome, files, resumed = executed
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
        echo(sentences.interruption_place(finished, folder), err=True)
        raise typer.Exit(INTERRUPTED) from None
    if json:
        print_outcome_json(outcome, files)
    elif not quiet:
        print_tables(outcome, si=si, whole=False)
        for sentence in sentences.work_summary(files, resumed, whole, monotonic() - began):
            echo(sentence)
    exit_by_outcome(outcome)


def _exit_by_part(solved: PartOutcome, whole: str, *, json: bool, quiet: bool) -> NoReturn:
    """Print what a part left and which of its runs failed, and exit by these."""
    if json:
        print_json({"failed": solved.failures, "left": solved.open_runs})
    elif not quiet:
        left = solved.open_runs
        echo(f"{left} of {whole} are left; the last part, or no --part, writes the table")
    for sentence in solved.failures:
        echo(sentence, err=True)
    raise typer.Exit(NOT_CONVERGED if solved.failures else 0)


@hookimpl
def register_commands(register: RegisterCommand) -> None:
    """Register the command."""
    register(run, file="pellicle.config.run:Run")
