"""The command line: parses and prints, nothing else.

Heavy imports are inside the commands, so that ``pellicle --help`` is there at once.
"""

from __future__ import annotations

import sys
import warnings
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.table import Table
from typer.core import TyperGroup

from .errors import ConfigError, PellicleError, PluginError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    import xarray as xr

    from .config import Run
    from .fitting.fit import Estimate, Fit
    from .fitting.pooled import PooledFit
    from .fitting.sources import Source
    from .result import Result
    from .study_config import Study

NOT_CONVERGED, BAD_INPUT, INTERRUPTED = 1, 2, 130


def _show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    typer.echo(f"warning: {message}", err=True)


class _Group(TyperGroup):
    """Turns errors into one message and an exit code: no traceback reaches a user."""

    def invoke(self, ctx: Any) -> Any:
        try:
            with warnings.catch_warnings():
                warnings.showwarning = _show_warning
                return super().invoke(ctx)
        except PellicleError as error:
            for line in str(error).splitlines():
                typer.echo(f"error: {line}", err=True)
            raise typer.Exit(BAD_INPUT) from None
        except Exception as error:
            # Noted by the orchestrator: the fault of a component, whose author wants its place.
            if not (notes := getattr(error, "__notes__", ())):
                raise
            typer.echo(f"error: {notes[0]}: {type(error).__name__}: {error}", err=True)
            raise typer.Exit(BAD_INPUT) from None
        except KeyboardInterrupt:
            typer.echo("interrupted", err=True)
            raise typer.Exit(INTERRUPTED) from None


app = typer.Typer(
    cls=_Group,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Contact mechanics of soft solids under a tensed skin.",
)


class Format(StrEnum):
    """File formats of figures."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"


@app.command()
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
        int | None, typer.Option(min=1, help="Threads of the Fourier transforms; all cores.")
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
    from .study_config import Study, from_toml

    made = from_toml(file, set_ or ())
    folder = directory or Path(file.stem)
    if dry_run:
        _print_plan(made, folder, file.stem, overwrite)
    elif isinstance(made, Study):
        _run_study(made, folder, quiet=quiet, threads=threads, overwrite=overwrite)
    else:
        _run_one(made, folder, file.stem, quiet=quiet, threads=threads, overwrite=overwrite)


def _run_one(
    made: Run, folder: Path, name: str, *, quiet: bool, threads: int | None, overwrite: bool
) -> None:
    from .components import Place
    from .orchestrator import execute, standard_outputs
    from .progress import Progress

    place = Place(folder, name, made.to_json(), made.identity, overwrite)
    bar = Progress(len(made.loading.values), not quiet)
    try:
        done = execute(made, place, standard_outputs(made.outputs), bar, threads=threads)
    except KeyboardInterrupt:
        typer.echo(f"interrupted; what steps were finished are in {folder}", err=True)
        raise typer.Exit(INTERRUPTED) from None
    if not quiet:
        _print_steps(done.result)
        if done.taken:
            all_ = len(made.loading.values)
            typer.echo(f"{done.taken} of {all_} steps were done before (--overwrite begins anew)")
        for path in done.files:
            typer.echo(f"wrote {path}")
    _exit_by_convergence(done.result)


def _run_study(
    made: Study, folder: Path, *, quiet: bool, threads: int | None, overwrite: bool
) -> None:
    from .study import carry_out

    try:
        done = carry_out(made, folder, progress=not quiet, overwrite=overwrite, threads=threads)
    except KeyboardInterrupt:
        typer.echo(
            f"interrupted; what was finished is in {folder}, and the same command goes on", err=True
        )
        raise typer.Exit(INTERRUPTED) from None
    if not quiet:
        _print_runs(done.table)
        if done.taken:
            all_ = len(made.points)
            typer.echo(f"{done.taken} of {all_} runs were done before (--overwrite begins anew)")
        for path in done.files:
            typer.echo(f"wrote {path}")
    _exit_by_status(done.table)


@app.command()
def fit(
    curves: Annotated[
        list[Path],
        typer.Argument(
            help="Files, or a folder of them: tables with a header such as position (um),force "
            "(nN); HDF5; formats of instruments. Or a table file,radius (um) that lists files."
        ),
    ],
    indenter: Annotated[
        str, typer.Option("--indenter", "-i", help="Type: paraboloid, sphere, cone, flat_punch, …")
    ],
    radius: Annotated[
        list[str] | None,
        typer.Option(help='Radius with its unit: "5 um"; repeat it to give one for each file.'),
    ] = None,
    half_angle: Annotated[
        str | None, typer.Option(help='Angle between axis and side of a cone: "70 degree".')
    ] = None,
    poissons_ratio: Annotated[
        float | None, typer.Option(help="Poisson's ratio, to get Young's modulus as well.")
    ] = None,
    fix: Annotated[
        list[str] | None,
        typer.Option(help='Hold a parameter: --fix tension=0, --fix reduced_modulus="10 kPa".'),
    ] = None,
    baseline: Annotated[
        str, typer.Option(help="Fitted of the force before contact: none, offset, slope.")
    ] = "none",
    segment: Annotated[str, typer.Option(help="Pass to fit: approach, retract.")] = "approach",
    spring_constant: Annotated[
        str | None, typer.Option(help='Of the cantilever, to subtract its bending: "0.05 N/m".')
    ] = None,
    sensitivity: Annotated[
        str | None, typer.Option(help='Deflection over the signal in volts: "50 nm/V".')
    ] = None,
    pool: Annotated[
        bool, typer.Option("--pool", help="Fit one modulus and one tension to all curves.")
    ] = False,
    executor: Annotated[
        str | None,
        typer.Option(help="What carries out many fits, and runs: serial, processes, dask."),
    ] = None,
    kernel: Annotated[
        str | None, typer.Option(help="Type of the solid, if it is no half-space: coated, …")
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help='Further fields: --set indenter.radius_x="5 um", --set executor.type=processes',
        ),
    ] = None,
    grid_points: Annotated[
        int | None, typer.Option(help="Cells along each grid, where contacts are simulated.")
    ] = None,
    cache: Annotated[
        Path | None, typer.Option(help="Folder that keeps simulated force curves.")
    ] = None,
    directory: Annotated[
        Path | None, typer.Option("-o", "--output", help="Folder for JSON, table and figure.")
    ] = None,
    report: Annotated[
        bool, typer.Option("--report", help="Leave a web page, there or in the current folder.")
    ] = False,
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Fit reduced modulus, tension and contact point to measured curves, with intervals.

    Exit code 0 only if every curve was fitted.
    """
    from .fitting.simulation import GRID_POINTS
    from .fitting.sources import gather
    from .study_config import DEFAULT_EXECUTOR

    shape = {"radius": radius[0] if radius and len(radius) == 1 else radius}
    fields = shape | {
        "half_angle": half_angle,
        "spring_constant": spring_constant,
        "sensitivity": sensitivity,
    }
    given = {name: value for name, value in fields.items() if value is not None}
    tables = _tables(
        {
            "indenter": {"type": indenter},
            "kernel": {} if kernel is None else {"type": kernel},
            "executor": {"type": executor or DEFAULT_EXECUTOR},
        },
        set_ or (),
    )
    options = {
        "kernel": tables["kernel"] or None,
        "poissons_ratio": poissons_ratio,
        "fix": dict(map(_assignment, fix or ())),
        "baseline": baseline,
        "segment": segment,
    }
    study = {
        "cache": cache,
        "executor": tables["executor"],
        "grid_points": GRID_POINTS if grid_points is None else grid_points,
    }
    if pool:
        _only_one(report)
        _fit_pooled(curves, tables["indenter"], options | given, study, directory, json=json)
        return
    sources = gather(curves, segment, given)
    if [source.name for source in sources] == [str(curves[0])]:
        made = _fit_one(sources[0], tables["indenter"], options, study)
        if json:
            _print_json(made.to_dict())
        else:
            _print_fit(made)
        for path in _fit_files(made, curves[0].stem, directory, report=report):
            typer.echo(f"wrote {path}", err=json)
    else:
        _only_one(report)
        _fit_many(sources, tables["indenter"], options, study, directory, json=json)


def _only_one(report: bool) -> None:
    if report:
        raise ConfigError("is of one curve; fit that one alone, or leave it out", "--report")


def _fit_one(
    source: Source, indenter: dict[str, Any], options: dict[str, Any], study: dict[str, Any]
) -> Fit:
    from .fitting.fit import cleaned, fitted, modelled, question

    measured = source.curve
    if isinstance(measured, PellicleError):
        raise measured
    is_depth = measured.depth is not None
    asked = question(indenter, source.fields, is_depth=is_depth, **options)
    curve = cleaned(measured, asked.segment)
    return fitted(curve, modelled(asked, curve, progress=sys.stderr.isatty(), **study))


def _fit_many(
    sources: list[Source],
    indenter: dict[str, Any],
    options: dict[str, Any],
    study: dict[str, Any],
    directory: Path | None,
    *,
    json: bool,
) -> None:
    from .fitting.many import carry_out

    try:
        done = carry_out(sources, indenter, options, directory=directory, progress=True, **study)
    except KeyboardInterrupt:
        kept = f"; what was finished is in {directory}, and the same command goes on"
        typer.echo(f"interrupted{kept if directory else ''}", err=True)
        raise typer.Exit(INTERRUPTED) from None
    if json:
        _print_json({"curves": done.rows})
    else:
        _print_fits(done.rows)
    if done.taken:
        typer.echo(f"{done.taken} of {len(sources)} fits were done before", err=json)
    for path in done.files:
        typer.echo(f"wrote {path}", err=json)
    if done.failed:
        typer.echo(f"{done.failed} of {len(sources)} curves could not be fitted", err=True)
        raise typer.Exit(NOT_CONVERGED)


def _fit_pooled(
    curves: list[Path],
    indenter: dict[str, Any],
    options: dict[str, Any],
    study: dict[str, Any],
    directory: Path | None,
    *,
    json: bool,
) -> None:
    from .fitting.pooled import fit_pooled

    made = fit_pooled(curves, indenter=indenter, progress=sys.stderr.isatty(), **options, **study)
    if json:
        _print_json(made.to_dict())
    else:
        _print_pooled(made)
    if directory is not None:
        from .fitting.pooled_drawing import save_figure

        files = made.save(directory / "pool.json"), save_figure(made, directory / "pool.png")
        for path in files:
            typer.echo(f"wrote {path}", err=json)


@app.command()
def plugins(
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """List the components that are installed, and what is broken and why."""
    from .plugins import registry

    found = registry()
    rows = [
        {
            "family": family,
            "type": registered.type,
            "origin": registered.origin.distribution,
            "version": registered.origin.version,
            "description": registered.summary,
        }
        for family, members in found.components.items()
        for registered in members.values()
    ]
    broken = [
        {
            "entry_point": broken.origin.entry_point,
            "origin": broken.origin.distribution,
            "version": broken.origin.version,
            "error": broken.error,
        }
        for broken in found.broken
    ] + [
        {
            "entry_point": f"{family}.{type_}",
            "origin": ", ".join(owner.distribution for owner in owners),
            "version": ", ".join(owner.version for owner in owners),
            "error": f"claimed by {' and by '.join(map(str, owners))}",
        }
        for (family, type_), owners in found.clashes.items()
    ]
    disabled = [str(origin) for origin in found.disabled]
    if json:
        _print_json({"components": rows, "broken": broken, "disabled": disabled})
        return
    _print_table(["family", "type", "origin", "version", "description"], rows)
    if broken:
        typer.echo("broken:")
        _print_table(["entry_point", "origin", "version", "error"], broken)
    for origin in disabled:
        typer.echo(f"switched off: {origin}")


@app.command()
def schema() -> None:
    """Print the JSON schema of a run or study file, with all installed components, for editors."""
    from .study_config import schema as make_schema

    _print_json(make_schema())


@app.command()
def new(
    path: Annotated[
        Path | None,
        typer.Argument(help="File to write, indent.toml; with --plugin, the component's name."),
    ] = None,
    plugin: Annotated[
        str | None,
        typer.Option(
            "--plugin",
            metavar="FAMILY",
            help="Write the package of a kernel, indenter, solver, correction, output or executor.",
        ),
    ] = None,
) -> None:
    """Write a commented starter file, or the package of a plugin."""
    if plugin is None:
        _write_starter(path or Path("indent.toml"))
        return
    from .scaffold import write_plugin

    if path is None:
        raise ConfigError(f"is missing; for example: pellicle new --plugin {plugin} mine", "NAME")
    folder = write_plugin(plugin, str(path), Path())
    typer.echo(f"wrote {folder}; next: cd {folder}, pip install -e ., python -m pytest")


@app.command()
def show(
    results: Annotated[
        Path, typer.Argument(help="Result file (.h5), or the folder or study.h5 of a study.")
    ],
) -> None:
    """Print the steps of a result, or the runs of a study, and where it comes from."""
    from .result import load
    from .study import is_table, read

    if is_table(results):
        table, _ = read(results)
        _print_origin(table)
        _print_runs(table)
        _exit_by_status(table)
        return
    result = load(results)
    _print_origin(result.dataset)
    wanted, done = _steps_wanted(result), result.dataset.sizes["step"]
    _print_steps(result)
    _print_contact(result)
    _exit_by_convergence(result)
    if done < wanted:
        typer.echo(f"interrupted: {done} of {wanted} steps are there; run it again", err=True)
        raise typer.Exit(NOT_CONVERGED)


@app.command()
def plot(
    results: Annotated[
        Path, typer.Argument(help="Result file (.h5), or the folder or study.h5 of a study.")
    ],
    directory: Annotated[
        Path | None, typer.Option("-o", "--output", help="Folder; that of the result.")
    ] = None,
    formats: Annotated[
        list[Format] | None, typer.Option("--format", help="png, svg or pdf; repeat for several.")
    ] = None,
) -> None:
    """Draw the figures of a result or of a study."""
    from .plotting import save_figures, save_study_figures
    from .result import load
    from .study import is_table, read

    chosen = [str(format_) for format_ in formats or [Format.PNG]]
    if is_table(results):
        table, folder = read(results)
        files = save_study_figures(table, directory or folder, "study", chosen)
    else:
        folder = directory or results.parent
        files = save_figures(load(results), folder, results.stem, chosen)
    for path in files:
        typer.echo(f"wrote {path}")


@app.command()
def validate() -> None:
    """Solve the shipped problems of known solution; exit code 0 only if all agree."""
    from .validation import validate as verdicts

    rows, passed = [], True
    for verdict in verdicts():
        case = verdict.case
        passed &= verdict.passed
        rows.append(
            {
                "case": case.name,
                "expected": f"{case.expected:.8g} {case.unit}",
                "computed": f"{verdict.computed:.8g} {case.unit}",
                "error": f"{verdict.error:.1e}",
                "allowed": f"{case.tolerance:.0e}",
                "verdict": "ok" if verdict.passed else "FAILED",
                "source": case.source,
            }
        )
    _print_table(["case", "expected", "computed", "error", "allowed", "verdict", "source"], rows)
    if not rows:
        raise PluginError("no cases are registered; see what is broken with `pellicle plugins`")
    raise typer.Exit(0 if passed else 1)


def _assignment(text: str) -> tuple[str, str | float]:
    """Return name and value of ``name=value``; a bare number is in SI."""
    name, equals, value = text.partition("=")
    if not equals:
        raise ConfigError(f"{text!r} is not of the form name=value, e.g. tension=0", "fix")
    try:
        return name.strip(), float(value)
    except ValueError:
        return name.strip(), value.strip()


def _fit_files(fit: Fit, stem: str, directory: Path | None, *, report: bool) -> Iterator[Path]:
    """Write what is asked for of a fit, and yield each file."""
    name = f"{stem}-fit"
    if directory is not None:
        from .fitting.drawing import save_figure

        yield fit.save(directory / f"{name}.json")
        yield save_figure(fit, directory / f"{name}.png")
    if report:
        from .fitting.report import save_report

        yield save_report(fit, (directory or Path()) / f"{name}.html", stem)


def _tables(tables: dict[str, Any], overrides: Iterable[str]) -> dict[str, Any]:
    """Return tables of components with what ``--set`` says put in."""
    from .model import nearest, replaced
    from .toml import parse_override

    for text in overrides:
        key, value = parse_override(text)
        table, _, field = key.partition(".")
        if table not in tables or not field:
            raise ConfigError(f"--set {text!r}: {table} is no table here; {nearest(table, tables)}")
        tables = replaced(tables, key, value)
    return tables


def _print_fit(fit: Fit) -> None:
    _print_estimates(fit.estimates())
    typer.echo(f"noise: {fit.noise:.3g} N, from {fit.noise_from}; {fit.points} points")
    for line in (fit.comparison, fit.advice):
        if line:
            typer.echo(line)
    for message in fit.messages:
        typer.echo(f"note: {message}", err=True)


def _print_pooled(fit: PooledFit) -> None:
    _print_estimates(fit.estimates())
    rows = [
        {
            "curve": curve.name,
            "contact_point [m]": f"{curve.contact_point.value:.6g}",
            "noise [N]": f"{curve.noise:.3g}",
            "points": str(curve.points),
            "chi_squared": f"{curve.chi_squared:.5g}",
            "alone: reduced_modulus [Pa]": f"{curve.reduced_modulus_alone:.4g}",
            "tension [N/m]": f"{curve.tension_alone:.4g}",
        }
        for curve in fit.curves
    ]
    _print_table(list(rows[0]), rows)
    for line in (fit.comparison, fit.agreement, fit.advice):
        typer.echo(line)
    for message in fit.messages:
        typer.echo(f"note: {message}", err=True)
    for curve in fit.curves:
        for message in curve.messages:
            typer.echo(f"note: {curve.name}: {message}", err=True)


def _print_estimates(estimates: Mapping[str, Estimate]) -> None:
    rows = []
    for name, estimate in estimates.items():
        interval = "held" if estimate.held else _interval(estimate.low, estimate.high)
        value = f"{estimate.value:.4g}"
        rows.append({"": name, "value": value, "95 % interval": interval, "unit": estimate.unit})
    _print_table(["", "value", "95 % interval", "unit"], rows)


def _interval(low: float | None, high: float | None) -> str:
    ends = ("open" if end is None else f"{end:.4g}" for end in (low, high))
    return " to ".join(ends)


def _print_fits(rows: list[dict[str, Any]]) -> None:
    """Print a line for each curve; what the fits themselves say is in the table that is kept."""
    names = {"reduced_modulus": "Pa", "tension": "N/m", "contact_point": "m"}
    shown = []
    for row in rows:
        line = {"curve": row["curve"]}
        for name, unit in names.items():
            found = row.get(name, {})
            line[f"{name} [{unit}]"] = f"{found['value']:.4g}" if found else ""
            if name != "contact_point":
                told = found and not found["held"]
                line[f"95 % of {name}"] = _interval(found["low"], found["high"]) if told else ""
        verdict, _, reason = row["status"].partition(": ")
        shown.append(line | {"notes": str(len(row.get("messages", ()))), "status": verdict})
        if reason:
            typer.echo(f"{row['curve']}: {reason}", err=True)
    _print_table(list(shown[0]), shown)


def _write_starter(path: Path) -> None:
    from importlib.resources import files

    from .errors import StorageError
    from .storage import reported

    text = files("pellicle").joinpath("starter.toml").read_text(encoding="utf-8")
    with reported(path):
        try:
            with path.open("x", encoding="utf-8") as file:
                file.write(text)
        except FileExistsError:
            raise StorageError(f"{path} exists already; give another name") from None
    typer.echo(f"wrote {path}; next: pellicle run {path}")


def _print_steps(result: Result) -> None:
    data = result.dataset
    areas = [str(name) for name in data.data_vars if str(name).startswith("contact_area")]
    asked = [name for name in ("mean_plane_depth", "stiffness") if name in data]
    if "contact_radius" in result.configuration["loading"]:
        asked.insert(0, "contact_radius")
    names = ["depth", "force", *areas, *asked, "iterations"]
    coarse = dict(result.coarse())
    rows = []
    for index in range(data.sizes["step"]):
        step = data.isel(step=index)
        row = {name: f"{step[name].item():.6g}" for name in names}
        status = "converged" if step["converged"].item() else "NOT CONVERGED"
        if index in coarse:
            status = "too coarse"
        rows.append({"step": str(index + 1), **row, "status": status})
    _print_table(["step", *names, "status"], rows, _heads(data, names))
    for index, (converged, status) in enumerate(
        zip(data["converged"], data["status"], strict=True)
    ):
        if converged and status != "converged" and index not in coarse:
            typer.echo(f"step {index + 1}: {status.item()}", err=True)


def _print_contact(result: Result) -> None:
    """Print a second table, of the shape of the contact."""
    from .dataset import OF_THE_CONTACT

    data = result.dataset
    # Files of earlier versions do not say it.
    names = [name for name in OF_THE_CONTACT if name in data]
    if not names:
        return
    typer.echo("contact:")
    rows = [
        {"step": str(index + 1), **{name: f"{data[name].values[index]:.6g}" for name in names}}
        for index in range(data.sizes["step"])
    ]
    _print_table(["step", *names], rows, _heads(data, names))


def _heads(data: xr.Dataset, names: list[str]) -> dict[str, str]:
    from .dataset import header

    return {name: header(name, data[name]) for name in names}


def _print_origin(data: xr.Dataset) -> None:
    for name in ("title", "date", "versions"):
        typer.echo(f"{name + ':':10}{data.attrs.get(name, '')}")


def _print_runs(table: xr.Dataset) -> None:
    """Print a row for each run of a study: its parameters, its last step and how it ended."""
    from .study import rows

    found = rows(table)
    names = list(found[0])
    units = {name: table[name].attrs.get("units", "1") for name in names if name in table}
    heads = {name: f"{name} [{unit}]" for name, unit in units.items() if unit != "1"}
    _print_table(names, found, heads)


def _print_plan(made: Run | Study, folder: Path, name: str, overwrite: bool) -> None:
    from .components import Place
    from .study import RunTask, plan, tasks
    from .study_config import Study

    if isinstance(made, Study):
        planned = list(plan(tasks(made, folder, overwrite=overwrite)))
    else:
        place = Place(folder, name, made.to_json(), made.identity, overwrite)
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
    _print_table(["run", "file", "points", "steps", "memory", "state"], rows)
    finished = sum(done >= task.steps for task, done, _ in planned)
    most = max(task.memory for task, *_ in planned) / 1e6
    typer.echo(
        f"{len(planned)} run{'s' * (len(planned) > 1)}, {finished} done, "
        f"{len(planned) - finished} to do; at most {most:.3g} MB each"
    )


def _exit_by_status(table: xr.Dataset) -> None:
    from .study import failures, reasons

    if message := failures(table):
        for reason in reasons(table):
            typer.echo(reason, err=True)
        typer.echo(message, err=True)
        raise typer.Exit(NOT_CONVERGED)


def _exit_by_convergence(result: Result) -> None:
    from .orchestrator import said_of_steps

    for index, message in result.failures():
        typer.echo(f"step {index + 1} did not converge: {message}", err=True)
    if coarse := result.coarse():
        _show_warning(said_of_steps(coarse))
    if not result.converged:
        raise typer.Exit(NOT_CONVERGED)


def _steps_wanted(result: Result) -> int:
    from .loading import Loading

    return len(Loading(**result.configuration["loading"]).values)


def _print_table(
    names: list[str], rows: list[dict[str, str]], heads: dict[str, str] | None = None
) -> None:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in names:
        table.add_column((heads or {}).get(name, name), overflow="fold")
    for row in rows:
        table.add_row(*(row[name] for name in names))
    # Into a pipe nothing is cut or folded.
    console = Console(markup=False, highlight=False)
    if not console.is_terminal:
        console.width = 1000
        console.soft_wrap = True
    console.print(table)


def _print_json(value: object) -> None:
    import json

    json.dump(value, sys.stdout, indent=2, ensure_ascii=False)
    sys.stdout.write("\n")
