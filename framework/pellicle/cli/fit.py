"""``pellicle fit``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from pellicle.errors import ConfigError

from .exits import INTERRUPTED, NOT_CONVERGED
from .print_fits import print_fit, print_fits
from .printing import print_json

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pellicle.fitting.fit import Fit
    from pellicle.fitting.many import Fitted
    from pellicle.fitting.pooled import PooledFit


def fit(
    curves: Annotated[
        list[Path],
        typer.Argument(
            help="Files, or a folder of them: tables with a header such as position (um),force "
            "(nN); HDF5; formats of instruments. Or a table file,radius (um) that lists files."
        ),
    ],
    indenter: Annotated[
        str,
        typer.Option(
            "--indenter",
            "-i",
            help="Type: sphere (a bead), paraboloid (Hertz, to 0.1 R), cone, flat_punch, …",
        ),
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
    contact_points: Annotated[
        bool,
        typer.Option("--contact-points", help="With --pool: intervals of contact points."),
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
    from pellicle.config.study import DEFAULT_EXECUTOR
    from pellicle.fitting.curves.sources import gather
    from pellicle.fitting.fit import fit_source
    from pellicle.fitting.many import carry_out
    from pellicle.fitting.models.simulation import GRID_POINTS
    from pellicle.fitting.pooled import pool_sources

    fields = {
        "radius": radius[0] if radius and len(radius) == 1 else radius,
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
    if contact_points and not pool:
        raise ConfigError("is of a pool; otherwise they have intervals anyway", "--contact-points")
    progress, wanted = sys.stderr.isatty(), _Wanted(directory, report, json)
    shape, sources = tables["indenter"], gather(curves, segment, given)
    if pool:
        pooled = pool_sources(
            sources, shape, options, contact_points=contact_points, progress=progress, **study
        )
        _leave(pooled, "pool", "Pooled fit", wanted)
    elif [source.name for source in sources] == [str(curves[0])]:
        made = fit_source(sources[0], shape, options, progress=progress, **study)
        _leave(made, f"{curves[0].stem}-fit", curves[0].stem, wanted)
    else:
        try:
            done = carry_out(sources, shape, options, directory=directory, progress=True, **study)
        except KeyboardInterrupt:
            kept = f"; what was finished is in {directory}, and the same command goes on"
            typer.echo(f"interrupted{kept if directory else ''}", err=True)
            raise typer.Exit(INTERRUPTED) from None
        _leave_table(done, wanted)


class _Wanted(NamedTuple):
    """What is to be left."""

    directory: Path | None
    report: bool
    json: bool

    def page(self, name: str) -> Path:
        return (self.directory or Path()) / f"{name}.html"


def _leave(made: Fit | PooledFit, name: str, title: str, wanted: _Wanted) -> None:
    """Print a fit, and leave its files."""
    from pellicle.fitting.report.figures import save_figure
    from pellicle.fitting.report.page import save_report

    if wanted.json:
        print_json(made.to_dict())
    else:
        print_fit(made)
    files = []
    if wanted.directory is not None:
        stem = wanted.directory / name
        files.append(made.save(stem.with_name(f"{name}.json")))
        files.append(save_figure(made, stem.with_name(f"{name}.png")))
    if wanted.report:
        files.append(save_report(made, wanted.page(name), title))
    for path in files:
        typer.echo(f"wrote {path}", err=wanted.json)


def _leave_table(done: Fitted, wanted: _Wanted) -> None:
    """Print many fits, and leave their page."""
    from pellicle.fitting.report.page import save_report

    count, files = len(done.rows), list(done.files)
    if wanted.json:
        print_json({"curves": done.rows})
    else:
        print_fits(done.rows)
    if done.taken:
        typer.echo(f"{done.taken} of {count} fits were done before", err=wanted.json)
    if wanted.report:
        files.append(save_report(done.rows, wanted.page("fits"), f"Fits of {count} curves"))
    for path in files:
        typer.echo(f"wrote {path}", err=wanted.json)
    if done.failed:
        typer.echo(f"{done.failed} of {count} curves could not be fitted", err=True)
        raise typer.Exit(NOT_CONVERGED)


def _tables(tables: dict[str, Any], overrides: Iterable[str]) -> dict[str, Any]:
    """Return tables of components with what ``--set`` says put in."""
    from pellicle.model.messages import nearest
    from pellicle.model.paths import replaced
    from pellicle.model.toml import parse_override

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
