"""``pellicle plot``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from .printing import echo


class Format(StrEnum):
    """File formats of figures."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"


def plot(
    results: Annotated[
        Path,
        typer.Argument(
            metavar="RESULTS", help="Folder of a run or study, result file (.h5) or study.h5."
        ),
    ],
    directory: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Folder (default: that of the result)."),
    ] = None,
    formats: Annotated[
        list[Format] | None,
        typer.Option("--format", metavar="FORMAT", help="png, svg or pdf; repeat for several."),
    ] = None,
) -> None:
    """Draw the figures of a result or of a study."""
    from pellicle.results.result import file_of_run, load
    from pellicle.show import figures, write_charts
    from pellicle.studies.runner import is_table, read

    chosen = [str(format_) for format_ in formats or [Format.PNG]]
    if is_table(results):
        table, folder = read(results)
        drawn, name = figures(table), "study"
    else:
        file = file_of_run(results)
        drawn, folder, name = figures(load(file)), file.parent, file.stem
    shown = ((f"-{suffix}", [figure]) for suffix, figure in drawn.items())
    for path in write_charts(shown, (directory or folder) / name, chosen):
        echo(f"wrote {path}")
