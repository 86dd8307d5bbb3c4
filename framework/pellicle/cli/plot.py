"""``pellicle plot``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from .printing import Stored, echo


class Format(StrEnum):
    """File formats of figures."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"


def plot(
    results: Stored,
    directory: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Folder (default: that of the result)."),
    ] = None,
    formats: Annotated[
        list[Format] | None,
        typer.Option("--format", metavar="FORMAT", help="png, svg or pdf; repeat for several."),
    ] = None,
) -> None:
    """Draw the figures of a result, of a study, or of what another command wrote."""
    from pellicle import registry
    from pellicle.components import Output
    from pellicle.results.result import file_of_run, load
    from pellicle.results.runs import StoredRuns
    from pellicle.studies.runner import is_table, read

    from .results import command_display

    names = [str(format_) for format_ in formats or [Format.PNG]]
    output = registry().make(Output, {"type": "figures", "formats": names})
    if is_table(results):
        table, folder = read(results)
        runs, name = StoredRuns.of_study(table, folder), "study"
    else:
        file = file_of_run(results)
        with command_display(file) as of_command:
            if of_command:
                for path in of_command.plot(directory or file.parent, names):
                    echo(f"wrote {path}")
                return
        runs, folder, name = StoredRuns.of_run(load(file).dataset), file.parent, file.stem
    for path in output.write(runs, (directory or folder) / name):
        echo(f"wrote {path}")
