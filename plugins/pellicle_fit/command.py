"""``pellicle fit``."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping, Sequence, Set
from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer
from typer import Option

import pellicle as pl
from pellicle.cli import NOT_CONVERGED, Format, InPart, echo, print_json
from pellicle.files import write_json

Text = str | None
Texts = list[str] | None
if TYPE_CHECKING:
    from pellicle.batch import Part

    from .config import FitConfig
    from .files.sources import Source
    from .population.fits import ManyFits
    from .result import Fit


_OF_INDENTER = {"radius", "diameter", "half_angle"}
"""Options that are fields of the indenter."""


def fit(
    context: typer.Context,
    files: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[CONFIG.toml] CURVES",
            help="A configuration, or the JSON of a fit to repeat; options replace its values. "
            "Curves: files or a folder of them: tables with a header such as position (um),"
            "force (nN); HDF5; formats of instruments. Or a table file,radius (um) that lists "
            "files.",
        ),
    ] = None,
    indenter: Annotated[
        Text, Option("-i", "--indenter", help="sphere (a bead), paraboloid (Hertz), cone, …")
    ] = None,
    radius: Annotated[Texts, Option(help='"5 um"; repeat it to give one for each file.')] = None,
    diameter: Annotated[Texts, Option(help="In place of the radius.")] = None,
    half_angle: Annotated[Text, Option(help='From axis to side of a cone: "70 degree".')] = None,
    poissons_ratio: Annotated[float | None, Option(help="To get Young's modulus as well.")] = None,
    thickness: Annotated[Text, Option(help="Of a layer on a rigid base, or free.")] = None,
    model: Annotated[Texts, Option(help="Effect in question: tension (default), …, none.")] = None,
    rivals: Annotated[
        Texts, Option(help="Effect to compare, or several (offset,slope), or none; repeat it.")
    ] = None,
    fix: Annotated[Texts, Option(metavar="NAME=VALUE", help="Fix a value: tension=0.")] = None,
    uncertainty: Annotated[
        Texts,
        Option(metavar="NAME=VALUE", help="Of spring_constant, sensitivity, radius: radius=5%."),
    ] = None,
    baseline: Annotated[Text, Option(help="To fit: none (default), offset, slope.")] = None,
    segment: Annotated[
        Text, Option(help="To fit: approach (default), approach+hold, retract, both.")
    ] = None,
    frequencies: Annotated[
        Texts, Option(metavar="F", help='Of sines in a hold: "10 Hz"; repeat it.')
    ] = None,
    lag: Annotated[Text, Option(help='Of the force behind the position: "0.2 ms".')] = None,
    spring_constant: Annotated[Text, Option(help='Of the cantilever: "0.05 N/m".')] = None,
    sensitivity: Annotated[Text, Option(help='Deflection over volts: "50 nm/V".')] = None,
    columns: Annotated[
        Text,
        Option(
            help='What columns are, by name, number or path: "Z = extension nm, Defl = deflection '
            'nm"; without units that the file has. Roles: position, depth, height, extension; '
            "force, deflection; time."
        ),
    ] = None,
    pool: Annotated[bool, Option("--pool", help="Fit one solid to all curves.")] = False,
    every_rival: Annotated[
        bool, Option("--every-rival", help="Of a folder, compare what a neighbour rules out, too.")
    ] = False,
    set_: Annotated[
        Texts,
        Option("--set", metavar="KEY=VALUE", help='Any other: --set indenter.radius_x="5 um".'),
    ] = None,
    directory: Annotated[
        Path | None, Option("-o", "--output", metavar="DIR", help="Folder for JSON and figures.")
    ] = None,
    part: InPart = None,
    formats: Annotated[
        list[Format] | None,
        Option("--format", metavar="FORMAT", help="Of figures: png (default), svg, pdf."),
    ] = None,
    report: Annotated[bool, Option("--report", help="Write a web page as well.")] = False,
    details: Annotated[bool, Option("--details", help="Print all that was compared.")] = False,
    si: Annotated[bool, Option("--si", help="Print tables in SI units.")] = False,
    json: Annotated[bool, Option("--json", help="Print JSON.")] = False,
    quiet: Annotated[bool, Option("--quiet", "-q", help="Print errors and warnings only.")] = False,
) -> None:
    """Fit reduced modulus, tension and contact point to measured curves, with intervals.

    Exit code 0 only if every curve was fitted, 1 if some could not be fitted.
    """
    from pellicle.batch import Part
    from pellicle.errors import ConfigError

    from .config import FitConfig
    from .displays import StoredFit, exit_by_fits
    from .population.fits import ManyFits
    from .print_fits import print_fit, print_fits
    from .report.figures import save_figure
    from .report.page import save_report

    curves = [*(files or ())]
    is_first = bool(curves) and curves[0].suffix.lower() in (".toml", ".json")
    first = curves.pop(0) if is_first else None
    pairs = {"fix": fix, "uncertainty": uncertainty}
    sets = [f"{name}.{text}" for name, texts in pairs.items() for text in texts or ()]
    fields = (FitConfig.model_fields.keys() | _OF_INDENTER) - pairs.keys()
    config = FitConfig.merged(
        first, [*sets, *(set_ or ())], curves=curves or None, **_given(fields, context.params)
    )
    kinds = [str(kind) for kind in formats or [Format.PNG]]
    share = Part.of_text(part)
    if share and directory is None:
        raise ConfigError("parts share a folder; name it (-o DIR)", "part")
    result, name, title = _fit(config, directory, kinds, share, quiet=quiet)
    many = result if isinstance(result, ManyFits) else ManyFits([])
    if many.left:
        _exit_by_part(many, json=json, quiet=quiet)
    written = [*many.files]
    if json:
        print_json(result.to_dict())
    elif isinstance(result, ManyFits):
        print_fits(result, quiet=quiet, directory=directory, si=si)
    else:
        print_fit(result, quiet=quiet, details=details, si=si)
    if directory is not None and not isinstance(result, ManyFits):
        written.append(write_json(result.to_dict(), directory / f"{name}.json"))
        written.append(StoredFit.write(result, directory / f"{name}.h5"))
        written += save_figure(result, directory / name, kinds)
    if report:
        written.append(save_report(result, (directory or Path()) / f"{name}.html", title))
    if many.resumed and not quiet:
        echo(f"{many.resumed} of {len(many.rows)} fits were done before")
    for path in () if quiet else written:
        echo(f"wrote {path}")
    exit_by_fits(many)


@pl.hookimpl
def register_commands(register: pl.RegisterCommand) -> None:
    """Register the command."""
    written = "pellicle_fit.displays:file_display"
    register(fit, file="pellicle_fit.config:FitConfig", written=written)


def _given(fields: Set[str], options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields that options give."""
    table = {name: value for name, value in options.items() if name in fields}
    # An option that is left out is None, a list without entries, or a flag that is off.
    table = {name: v for name, v in table.items() if v not in (None, ()) and v is not False}
    for name in table.keys() & {"radius", "diameter"}:
        first, *others = table[name]
        table[name] = [first, *others] if others else first
    if "model" in table:
        table["model"] = [name for name in table["model"] if name != "none"]
    if "rivals" in table:
        table["rivals"] = [text.split(",") for text in table["rivals"] if text != "none"]
    return table


def _fit(
    config: FitConfig,
    directory: Path | None,
    formats: Sequence[str],
    part: Part | None,
    *,
    quiet: bool,
) -> tuple[Fit | ManyFits, str, str]:
    """Return the fit of the curves, the name of its files and the title of its page."""
    from pellicle.errors import ConfigError

    from .many import fit_sources
    from .problem import problem

    progress, stream = not quiet and sys.stderr.isatty(), config.sources()
    first = [*islice(stream, None if config.pool else 2)]
    if config.pool or [source.name for source in first] == [str(config.curves[0])]:
        if part:
            raise ConfigError("a fit of one curve, or of a pool, has no parts", "part")
        fit = problem(config, first, progress=progress).fit(progress=progress)
        stem = config.curves[0].stem
        return (fit, "pool", "Pooled fit") if config.pool else (fit, f"{stem}-fit", stem)
    sources: Iterable[Source] = chain(first, stream)
    is_shown = not quiet
    if part:
        fits = fit_sources(config, sources, directory, progress=is_shown, part=part)
        if fits.left:
            return fits, "", ""
        sources = config.sources()
    fits = fit_sources(
        config, sources, directory, progress=is_shown, formats=formats, wait=bool(part)
    )
    return fits, "fits", f"Fits of {len(fits.rows)} curves"


def _exit_by_part(fits: ManyFits, *, json: bool, quiet: bool) -> NoReturn:
    """Print how many curves a part left and which it could not fit, and exit by these."""
    failed = [row for row in fits.rows if row.failure]
    if json:
        print_json({"failed": [row.to_dict() for row in failed], "left": fits.left})
    elif not quiet:
        echo(f"curves left: {fits.left}; the last part, or no --part, writes the table")
    for row in failed:
        echo(f"{row.name}: {row.failure}", err=True)
    raise typer.Exit(NOT_CONVERGED if failed else 0)
