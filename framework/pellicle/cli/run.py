"""``pellicle run``."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from pellicle.errors import ConfigError
from pellicle.hookspecs import RegisterCommand, hookimpl

from .printing import INTERRUPTED, echo, print_json, print_table, print_warning

if TYPE_CHECKING:
    from pellicle.config.run import Run
    from pellicle.config.study import Study


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
    si: Annotated[bool, typer.Option("--si", help="Print numbers in SI units.")] = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print the result as JSON, in SI units.")
    ] = False,
) -> None:
    """Solve a run, or all runs of a study, and write the results; continue after an interruption.

    Exit code 0 only if every step converged.
    """
    from pellicle.config.doubtful_scales import doubtful_scales
    from pellicle.config.study import Study, from_toml

    configuration = from_toml(file, set_ or ())
    for doubt in doubtful_scales(configuration).values():
        print_warning(doubt)
    folder = directory or Path(file.stem)
    display = _Display(quiet, si, json)
    if dry_run:
        _print_plan(configuration, folder / file.stem, overwrite, json)
    elif isinstance(configuration, Study):
        _run_study(configuration, folder, display, threads=threads, overwrite=overwrite)
    else:
        stem = folder / file.stem
        _run_one(configuration, stem, display, threads=threads, overwrite=overwrite)


@hookimpl
def register_commands(register: RegisterCommand) -> None:
    """Register the command."""
    register(run, file="pellicle.config.run:Run")


class _Display(NamedTuple):
    """How a result is printed."""

    quiet: bool
    si: bool
    json: bool


def _print_plan(configuration: Run | Study, stem: Path, overwrite: bool, json: bool) -> None:
    from pellicle.config.study import Study
    from pellicle.runs.journal import Journal
    from pellicle.show import plan
    from pellicle.studies.runner import RunTask, tasks

    if isinstance(configuration, Study):
        planned = tasks(configuration, stem.parent, overwrite=overwrite)
    else:
        journal = Journal(stem, configuration.identity, overwrite)
        planned = [RunTask(configuration.title or stem.name, configuration, journal)]
    table, sentence = plan.planned(planned)
    if json:
        print_json({"runs": table.records})
        return
    print_table(table)
    echo(sentence)


def _run_one(
    run: Run, stem: Path, display: _Display, *, threads: int | None, overwrite: bool
) -> None:
    from pellicle.contact.caveats import Status
    from pellicle.runs.advice import size_for
    from pellicle.runs.journal import Journal
    from pellicle.runs.progress import RunProgress
    from pellicle.runs.runner import execute, standard_outputs
    from pellicle.show import plan
    from pellicle.show.tables import main_steps

    from .results import exit_by_convergence, print_result_json

    steps = len(run.loading.values)
    journal, bar = Journal(stem, run.identity, overwrite), RunProgress(steps, not display.quiet)
    try:
        executed = execute(run, journal, standard_outputs(run.outputs), bar, threads=threads)
    except KeyboardInterrupt:
        echo(plan.interrupted(stem.parent, is_study=False), err=True)
        raise typer.Exit(INTERRUPTED) from None
    if display.json:
        print_result_json(executed.result, executed.files)
    elif not display.quiet:
        print_table(main_steps(executed.result.dataset), si=display.si)
        for sentence in plan.done(executed.files, executed.resumed, f"{steps} steps"):
            echo(sentence)
    codes = executed.result.dataset["status_code"].values
    if Status.CONTACT_AT_EDGE.name in codes:
        with suppress(ConfigError):
            echo(plan.larger_domain(size_for(run), stem.parent), err=True)
    exit_by_convergence(executed.result)


def _run_study(
    study: Study, folder: Path, display: _Display, *, threads: int | None, overwrite: bool
) -> None:
    from pellicle.show import plan
    from pellicle.studies.runner import execute

    from .results import exit_by_status, print_runs, print_study_json

    try:
        result = execute(
            study, folder, progress=not display.quiet, overwrite=overwrite, threads=threads
        )
    except KeyboardInterrupt:
        echo(plan.interrupted(folder, is_study=True), err=True)
        raise typer.Exit(INTERRUPTED) from None
    if display.json:
        print_study_json(result.table, result.files)
    elif not display.quiet:
        print_runs(result.table, si=display.si)
        for sentence in plan.done(result.files, result.resumed, f"{len(study.points)} runs"):
            echo(sentence)
    exit_by_status(result.table)
