"""``pellicle new``."""

from __future__ import annotations

import re
import sys
from importlib.resources import files
from importlib.util import find_spec
from keyword import iskeyword
from pathlib import Path
from string import Template
from typing import Annotated

import typer

from pellicle.errors import ConfigError, StorageError
from pellicle.files import storage_errors
from pellicle.plugins.commands import usable_commands

from .printing import echo

_NAME = re.compile(r"[a-z][a-z0-9]*([-_][a-z0-9]+)*")


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
            help="Write the package of a kernel, indenter, load, interaction, solver, correction, "
            "output, executor or prescription, or of a plugin's family, such as effect or reader.",
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
    with storage_errors(path):
        try:
            with path.open("xb") as file:
                file.write(content)
        except FileExistsError:
            raise StorageError(f"{path} exists already; give another name") from None


def write_plugin(family: str, name: str, parent: Path) -> Path:
    """Write a complete package that adds a component, and return its folder, inside ``parent``.

    The package of the family's base class has a folder ``templates/FAMILY``; what belongs to its
    example is copied as it is. ``name`` is the component's type, such as ``graded`` or
    ``graded-solid``.
    """
    template = _template(family)
    names = _names(family, name)
    folder = parent / names["distribution"]
    package = files("pellicle") / "templates" / "package"
    sources = {
        "pyproject.toml": package / "pyproject.toml",
        "README.md": package / "README.md",
        f"{names['module']}.py": template / "module",
        f"test_{names['module']}.py": template / "test",
        f"{names['type']}.toml": template / "example",
        **{file.name: file for file in template.iterdir() if file.suffix},
    }
    if folder.exists():
        raise StorageError(f"{folder} exists already; give another name")
    with storage_errors(folder):
        folder.mkdir()
        for file, source in sources.items():
            text = Template(source.read_text(encoding="utf-8")).substitute(names)
            (folder / file).write_text(text, encoding="utf-8")
    return folder


def _template(family: str) -> Path:
    """Return the folder of a family's template, in the package of its base class."""
    from pellicle.components.installed import registry

    families = registry().families
    if family not in families:
        raise ConfigError(
            f"{family!r} is not a family; give one of {', '.join(families)}", "--plugin"
        )
    package = families[family].__module__.partition(".")[0]
    for path in getattr(sys.modules[package], "__path__", ()):
        if (template := Path(path, "templates", family)).is_dir():
            return template
    raise ConfigError(f"{package} has no template of the family {family!r}", "--plugin")


def _names(family: str, name: str) -> dict[str, str]:
    from pellicle.components.installed import registry

    type_ = name.replace("-", "_")
    class_name = "".join(word.capitalize() for word in type_.split("_"))
    if not _NAME.fullmatch(name) or iskeyword(type_) or iskeyword(class_name):
        raise ConfigError(
            f"{name!r} cannot be the name of a component; give lower-case words of letters a to z "
            "and digits, joined by - or _, such as 'graded-solid'",
            "NAME",
        )
    if owner := registry().components[family].get(type_):
        raise ConfigError(
            f"{family} {type_!r} is there already, from {owner.origin}; give another", "NAME"
        )
    module = f"pellicle_{type_}"
    package = registry().families[family].__module__.partition(".")[0]
    takes_file = {c.file.partition(".")[0]: name for name, c in usable_commands().items() if c.file}
    return {
        "family": family,
        "command": takes_file.get(package, "run"),
        "type": type_,
        "class_name": class_name,
        "module": module,
        "distribution": module.replace("_", "-"),
    }
