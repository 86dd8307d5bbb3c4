"""``pellicle new``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pellicle.errors import ConfigError, StorageError

from .printing import echo


def new(
    path: Annotated[
        Path | None,
        typer.Argument(
            metavar="PATH",
            help="File to write (default: indent.toml); with --plugin, the component's name.",
        ),
    ] = None,
    plugin: Annotated[
        str | None,
        typer.Option(
            "--plugin",
            metavar="FAMILY",
            help="Write the package of a kernel, indenter, interaction, solver, correction, "
            "output, executor or prescription.",
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
    echo(f"wrote {folder}; next: cd {folder}, pip install -e '.[test]', python -m pytest")


def _write_starter(path: Path) -> None:
    from importlib.resources import files

    from pellicle.files import storage_errors

    text = files("pellicle.cli").joinpath("starter.toml").read_text(encoding="utf-8")
    with storage_errors(path):
        try:
            with path.open("x", encoding="utf-8") as file:
                file.write(text)
        except FileExistsError:
            raise StorageError(f"{path} exists already; give another name") from None
    echo(f"wrote {path}; next: pellicle run {path}")
