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
        typer.Option("-o", "--output", help="Folder for the results; FILE's name without .toml."),
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
            min=1, help="Threads of the Fourier transforms; if not given, what is fastest."
        ),
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Begin anew, in place of whatever result is there.")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Print what would be run, and run nothing.")
    ] = False,
) -> None:
    """Solve a run, or all runs of a study, and leave the results; go on where it was interrupted.

    Exit code 0 only if every step converged.
    """
    from pellicle.config.study import Study, from_toml

    made = from_toml(file, set_ or ())
    folder = directory or Path(file.stem)
    if dry_run:
        _print_plan(made, folder, file.stem, overwrite)
    elif isinstance(made, Study):
        _run_study(made, folder, quiet=quiet, threads=threads, overwrite=overwrite)
    else:
        _run_one(made, folder, file.stem, quiet=quiet, threads=threads, overwrite=overwrite)


def _print_plan(made: Run | Study, folder: Path, name: str, overwrite: bool) -> None:
    from pellicle.components import Place
    from pellicle.config.study import Study
    from pellicle.studies.runner import RunTask, plan, tasks

    if isinstance(made, Study):
        planned = list(plan(tasks(made, folder, overwrite=overwrite)))
    else:
        place = Place(folder, name, made.to_json(as_given=True), made.identity, overwrite)
        planned = list(plan([RunTask(made.title or name, made, place)]))
    rows = []
    for task, done, problem in planned:
        nx, ny = task.run.grid.points
        state = f"{done} of {task.steps} steps done" if done < task.steps else "done"
        rows.append(
            {
                "run": task.name,
                "file": str(task.place.file(".h5")),
                "points": f"{nx} × {ny}",
                "steps": str(task.steps),
                "memory": f"{task.memory / 1e6:.3g} MB",
                "state": problem or (state if done else "to do"),
            }
        )
    print_table(["run", "file", "points", "steps", "memory", "state"], rows)
    finished = sum(done >= task.steps for task, done, _ in planned)
    most = max(task.memory for task, *_ in planned) / 1e6
    typer.echo(
        f"{len(planned)} run{'s' * (len(planned) > 1)}, {finished} done, "
        f"{len(planned) - finished} to do; at most {most:.3g} MB each"
    )


def _run_one(
    made: Run, folder: Path, name: str, *, quiet: bool, threads: int | None, overwrite: bool
) -> None:
    from pellicle.components import Place
    from pellicle.runs.progress import Progress
    from pellicle.runs.runner import execute, standard_outputs

    place = Place(folder, name, made.to_json(as_given=True), made.identity, overwrite)
    bar = Progress(len(made.loading.values), not quiet)
    try:
        done = execute(made, place, standard_outputs(made.outputs), bar, threads=threads)
    except KeyboardInterrupt:
        typer.echo(f"interrupted; what steps were finished are in {folder}", err=True)
        raise typer.Exit(INTERRUPTED) from None
    if not quiet:
        print_steps(done.result)
        if done.taken:
            all_ = len(made.loading.values)
            typer.echo(f"{done.taken} of {all_} steps were done before (--overwrite begins anew)")
        for path in done.files:
            typer.echo(f"wrote {path}")
    exit_by_convergence(done.result)


def _run_study(
    made: Study, folder: Path, *, quiet: bool, threads: int | None, overwrite: bool
) -> None:
    from pellicle.studies.runner import carry_out

    try:
        done = carry_out(made, folder, progress=not quiet, overwrite=overwrite, threads=threads)
    except KeyboardInterrupt:
        typer.echo(
            f"interrupted; what was finished is in {folder}, and the same command goes on", err=True
        )
        raise typer.Exit(INTERRUPTED) from None
    if not quiet:
        print_runs(done.table)
        if done.taken:
            all_ = len(made.points)
            typer.echo(f"{done.taken} of {all_} runs were done before (--overwrite begins anew)")
        for path in done.files:
            typer.echo(f"wrote {path}")
    exit_by_status(done.table)
