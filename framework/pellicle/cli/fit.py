"""``pellicle fit``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pellicle.errors import ConfigError

from .exits import INTERRUPTED, NOT_CONVERGED
from .fits import print_fit, print_fits, print_pooled
from .printing import print_json

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from pellicle.fitting.fit import Fit
    from pellicle.fitting.sources import Source


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
    from pellicle.fitting.fit import fit_source
    from pellicle.fitting.simulation import GRID_POINTS
    from pellicle.fitting.sources import gather
    from pellicle.study_config import DEFAULT_EXECUTOR

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
        made = fit_source(
            sources[0], tables["indenter"], options, progress=sys.stderr.isatty(), **study
        )
        if json:
            print_json(made.to_dict())
        else:
            print_fit(made)
        for path in _fit_files(made, curves[0].stem, directory, report=report):
            typer.echo(f"wrote {path}", err=json)
    else:
        _only_one(report)
        _fit_many(sources, tables["indenter"], options, study, directory, json=json)


def _only_one(report: bool) -> None:
    if report:
        raise ConfigError("is of one curve; fit that one alone, or leave it out", "--report")


def _fit_many(
    sources: list[Source],
    indenter: dict[str, Any],
    options: dict[str, Any],
    study: dict[str, Any],
    directory: Path | None,
    *,
    json: bool,
) -> None:
    from pellicle.fitting.many import carry_out

    try:
        done = carry_out(sources, indenter, options, directory=directory, progress=True, **study)
    except KeyboardInterrupt:
        kept = f"; what was finished is in {directory}, and the same command goes on"
        typer.echo(f"interrupted{kept if directory else ''}", err=True)
        raise typer.Exit(INTERRUPTED) from None
    if json:
        print_json({"curves": done.rows})
    else:
        print_fits(done.rows)
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
    from pellicle.fitting.pooled import fit_pooled

    made = fit_pooled(curves, indenter=indenter, progress=sys.stderr.isatty(), **options, **study)
    if json:
        print_json(made.to_dict())
    else:
        print_pooled(made)
    if directory is not None:
        from pellicle.fitting.pooled_drawing import save_figure

        files = made.save(directory / "pool.json"), save_figure(made, directory / "pool.png")
        for path in files:
            typer.echo(f"wrote {path}", err=json)


def _fit_files(fit: Fit, stem: str, directory: Path | None, *, report: bool) -> Iterator[Path]:
    """Write what is asked for of a fit, and yield each file."""
    name = f"{stem}-fit"
    if directory is not None:
        from pellicle.fitting.drawing import save_figure

        yield fit.save(directory / f"{name}.json")
        yield save_figure(fit, directory / f"{name}.png")
    if report:
        from pellicle.fitting.report import save_report

        yield save_report(fit, (directory or Path()) / f"{name}.html", stem)


def _tables(tables: dict[str, Any], overrides: Iterable[str]) -> dict[str, Any]:
    """Return tables of components with what ``--set`` says put in."""
    from pellicle.model import nearest, replaced
    from pellicle.toml import parse_override

    for text in overrides:
        key, value = parse_override(text)
        table, _, field = key.partition(".")
        if table not in tables or not field:
            raise ConfigError(f"--set {text!r}: {table} is no table here; {nearest(table, tables)}")
        tables = replaced(tables, key, value)
    return tables


def _assignment(text: str) -> tuple[str, str | float]:
    """Return name and value of ``name=value``; a bare number is in SI."""
    name, equals, value = text.partition("=")
    if not equals:
        raise ConfigError(f"{text!r} is not of the form name=value, e.g. tension=0", "fix")
    try:
        return name.strip(), float(value)
    except ValueError:
        return name.strip(), value.strip()
