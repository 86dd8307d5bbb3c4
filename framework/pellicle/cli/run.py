"""``pellicle run``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .exits import INTERRUPTED
from .printing import print_table
from .results import exit_by_convergence, exit_by_status, print_runs, print_steps

if TYPE_CHECKING:
    from pellicle.config.run import Run
    from pellicle.config.study import Study


def run(
    file: Annotated[Path, typer.Argument(help="TOML file (`pellicle new` writes one).")],
    directory: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", help="Folder for the results (default: FILE's name without .toml)."
        ),
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", help='Replace a value: --set kernel.tension="5 mN/m".'),
    ] = None,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="Print errors and warnings only.")
    ] = False,
    threads: Annotated[
        int | None,
        typer.Option(
            min=1, help="Threads of the Fourier transforms (default: the fastest number)."
        ),
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Start over and replace an existing result.")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Print the planned runs without executing them.")
    ] = False,
) -> None:
    """Solve a run, or all runs of a study, and write the results; continue after an interruption.

    Exit code 0 only if every step converged.
    """
    from pellicle.config.study import Study, from_toml

    configuration = from_toml(file, set_ or ())
    folder = directory or Path(file.stem)
    if dry_run:
        _print_plan(configuration, folder / file.stem, overwrite)
    elif isinstance(configuration, Study):
        _run_study(configuration, folder, quiet=quiet, threads=threads, overwrite=overwrite)
    else:
        stem = folder / file.stem
        _run_one(configuration, stem, quiet=quiet, threads=threads, overwrite=overwrite)


def _print_plan(configuration: Run | Study, stem: Path, overwrite: bool) -> None:
    from pellicle.config.study import Study
    from pellicle.runs.journal import Journal
    from pellicle.studies.runner import RunTask, plan, tasks

    if isinstance(configuration, Study):
        planned = list(plan(tasks(configuration, stem.parent, overwrite=overwrite)))
    else:
        journal = Journal(stem, configuration.identity, overwrite)
        planned = list(plan([RunTask(configuration.title or stem.name, configuration, journal)]))
    rows = []
    for task, finished, problem in planned:
        nx, ny = task.run.grid.points
        state = f"{finished} of {task.steps} steps done" if finished < task.steps else "done"
        rows.append(
            {
                "run": task.name,
                "file": str(task.journal.path),
                "points": f"{nx} × {ny}",
                "steps": str(task.steps),
                "memory": f"{task.memory / 1e6:.3g} MB",
                "state": problem or (state if finished else "to do"),
            }
        )
    print_table(["run", "file", "points", "steps", "memory", "state"], rows)
    done = sum(finished >= task.steps for task, finished, _ in planned)
    most = max(task.memory for task, *_ in planned) / 1e6
    typer.echo(
        f"{len(planned)} run{'s' * (len(planned) > 1)}, {done} done, "
        f"{len(planned) - done} to do; at most {most:.3g} MB each"
    )


def _run_one(run: Run, stem: Path, *, quiet: bool, threads: int | None, overwrite: bool) -> None:
    from pellicle.runs.journal import Journal
    from pellicle.runs.progress import Progress
    from pellicle.runs.runner import execute, standard_outputs

    steps = len(run.loading.values)
    journal, bar = Journal(stem, run.identity, overwrite), Progress(steps, not quiet)
    try:
        executed = execute(run, journal, standard_outputs(run.outputs), bar, threads=threads)
    except KeyboardInterrupt:
        typer.echo(f"interrupted; finished steps are in {stem.parent}", err=True)
        raise typer.Exit(INTERRUPTED) from None
    if not quiet:
        print_steps(executed.result)
        _print_files(executed.files, executed.resumed, f"{steps} steps")
    exit_by_convergence(executed.result)


def _run_study(
    study: Study, folder: Path, *, quiet: bool, threads: int | None, overwrite: bool
) -> None:
    from pellicle.studies.runner import execute

    try:
        result = execute(study, folder, progress=not quiet, overwrite=overwrite, threads=threads)
    except KeyboardInterrupt:
        typer.echo(
            f"interrupted; finished runs are in {folder}, and the same command continues", err=True
        )
        raise typer.Exit(INTERRUPTED) from None
    if not quiet:
        print_runs(result.table)
        _print_files(result.files, result.resumed, f"{len(study.points)} runs")
    exit_by_status(result.table)


def _print_files(files: tuple[Path, ...], resumed: int, whole: str) -> None:
    if resumed:
        typer.echo(f"{resumed} of {whole} were done before (--overwrite starts over)")
    for path in files:
        typer.echo(f"wrote {path}")
