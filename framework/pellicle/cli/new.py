"""``pellicle new``."""

from __future__ import annotations

import re
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from pellicle.commands import usable_commands
from pellicle.errors import ConfigError, StorageError

from .printing import echo


def new(
    path: Annotated[
        Path | None,
        typer.Argument(
            metavar="PATH",
            help="File to write (default: indent.toml, or EXAMPLE.toml); with --plugin, the "
            "component's name.",
        ),
    ] = None,
    example: Annotated[
        str | None,
        typer.Option(
            "--example",
            metavar="EXAMPLE",
            help="Write an example that runs as it is, such as rough; any other name lists all.",
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
    """Write a commented starter file, an example, or the package of a plugin."""
    if path is not None and plugin is None and not path.suffix:
        # The folder of results is named after the file without its suffix.
        path = path.with_suffix(".toml")
    if plugin is None:
        _write_example(example or "indent", path)
        return
    if example is not None:
        raise ConfigError("and --plugin exclude each other; give one of them", "--example")
    from .scaffold import write_plugin

    if path is None:
        raise ConfigError(f"is missing; for example: pellicle new --plugin {plugin} mine", "NAME")
    folder = write_plugin(plugin, str(path), Path())
    echo(f"wrote {folder}; next: cd {folder}, pip install -e '.[test]', python -m pytest")


def _write_example(name: str, path: Path | None) -> None:
    """Write an example with the files beside it, whose names follow that of its TOML file."""
    examples = _examples()
    if name not in examples:
        raise ConfigError(
            f"{name!r} is not an example; give one of {', '.join(examples)}", "--example"
        )
    command, source = examples[name]
    path = path or Path(f"{name}.toml")
    text = source.read_text(encoding="utf-8")
    for beside in sorted({*source.parent.glob("[!.]*.*")} - {source}):
        copy = path.with_name(beside.name.replace(name, path.stem))
        _write_new(copy, beside.read_bytes())
        text = text.replace(beside.name, copy.name)
    _write_new(path, text.encode())
    echo(f"wrote {path}; next: pellicle {command} {path}")


def _examples() -> dict[str, tuple[str, Path]]:
    """Return the command and the TOML file of each example in the packages of commands."""
    examples: dict[str, tuple[str, Path]] = {}
    for name, command in usable_commands().items():
        package = re.split("[.:]", command.file)[0]
        spec = find_spec(package) if package else None
        for folder in (spec and spec.submodule_search_locations) or ():
            for file in sorted(Path(folder, "examples").glob("*/*.toml")):
                if file.stem == file.parent.name:
                    examples.setdefault(file.stem, (name, file))
    return examples


def _write_new(path: Path, content: bytes) -> None:
    """Write a file that must not exist.

    Raises
    ------
    StorageError
        It exists, or cannot be written.
    """
    from pellicle.files import storage_errors

    with storage_errors(path):
        try:
            with path.open("xb") as file:
                file.write(content)
        except FileExistsError:
            raise StorageError(f"{path} exists already; give another name") from None
