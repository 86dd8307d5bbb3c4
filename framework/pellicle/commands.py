"""The commands of the command line, found by name, imported when used.

An entry point ``command.NAME`` names a function, or a `Command` that tells more about it; those of
pellicle itself are found in the same way. Nothing heavy is imported to list them.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache, partial
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from .errors import ConfigError, PellicleError, PluginError
from .origins import COMMAND, DISABLE, GROUP, Broken, Origin, isolated

if TYPE_CHECKING:
    from pydantic import BaseModel


@dataclass(frozen=True)
class Command:
    """A command of the command line.

    Raises
    ------
    PluginError
        A value is not of the form that is asked for.
    """

    function: Callable[..., None]
    """Its parameters are those of the command, as typer reads them; its documentation is the help.

    The module of the function imports typer alone; what is heavy is imported inside the function.
    """
    file: str = ""
    """``"package.module:Model"``: the model of the TOML file that the command takes.

    Folders ``examples/NAME/`` of the package hold examples of it for ``pellicle new --example``.
    """
    show: Callable[[Path, bool, bool], bool] | None = None
    """Prints what the command left at a path, for ``pellicle show``, in SI or as JSON if asked to.

    It returns False, and prints nothing, where the command left nothing there.
    """

    def __post_init__(self) -> None:
        if not callable(self.function):
            raise PluginError(f"{self.function!r} is neither a function nor a pellicle.cli.Command")
        if self.file and not re.fullmatch(r"[\w.]+:\w+", self.file):
            raise PluginError(f"file is {self.file!r}; give one like 'package.module:Model'")


@cache
def commands() -> Mapping[str, Sequence[EntryPoint]]:
    """Return who claims each command: pellicle itself first, nobody who is switched off."""
    claims: dict[str, list[EntryPoint]] = {}
    disable = os.environ.get(DISABLE, "")
    for entry in sorted({*entry_points(group=GROUP)}, key=lambda entry: (entry.name, entry.value)):
        name = entry.name.removeprefix(COMMAND)
        if name != entry.name and not (disable and Origin.of(entry).is_disabled(disable)):
            claims.setdefault(name, []).append(entry)
    for entries in claims.values():
        if len(entries) > 1:
            entries.sort(key=lambda entry: not Origin.of(entry).is_own)
    return claims


@cache
def claims_on(name: str) -> Sequence[Command | Broken]:
    """Return what each claimant of a command brings, or why it cannot be used.

    Of several plugins none is used, and beside pellicle itself none either.
    """
    entries = commands()[name]
    if len(entries) == 1:
        return [isolated(entries[0], partial(_loaded, entries[0]))]
    origins = list(map(Origin.of, entries))
    error = (
        f"claimed by {' and by '.join(map(str, origins))}; uninstall one, or name its "
        f"distribution in {DISABLE}"
    )
    return [
        isolated(entry, partial(_loaded, entry)) if origin.is_own else Broken(origin, error)
        for entry, origin in zip(entries, origins, strict=True)
    ]


def load_command(name: str) -> Command | Broken:
    """Return the command of a name, or why it cannot be used."""
    return claims_on(name)[0]


def _loaded(entry: EntryPoint) -> Command:
    loaded = entry.load()
    return loaded if isinstance(loaded, Command) else Command(loaded)


def typer_command(name: str, **options: Any) -> Any:
    """Return what typer makes of a command, with options of `typer.Typer.command`; or `Broken`."""
    command = load_command(name)
    if isinstance(command, Broken):
        return command
    app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    app.command(name, **options)(command.function)
    return isolated(commands()[name][0], partial(typer.main.get_command, app))


@contextmanager
def errors_attributed_to(name: str) -> Iterator[None]:
    """Add a note that names a command of a plugin to its errors, but for those meant for users."""
    try:
        yield
    except (PellicleError, typer.Exit, typer.Abort):
        raise
    except Exception as error:
        if not (origin := Origin.of(commands()[name][0])).is_own:
            error.add_note(f"command {name!r} of {origin} failed")
        raise


def file_models() -> Mapping[str, type[BaseModel] | Broken]:
    """Return the model of the file of each command that takes one, or why it cannot be used."""
    models: dict[str, type[BaseModel] | Broken] = {}
    for name, (entry, *_) in commands().items():
        command = load_command(name)
        if isinstance(command, Command) and command.file:
            model = isolated(entry, partial(_model, command.file))
            if isinstance(model, Broken):
                model = replace(model, error=f"file {command.file!r}: {model.error}")
            models[name] = model
    return models


def _model(file: str) -> type[BaseModel]:
    from pydantic import BaseModel

    model = EntryPoint("file", file, GROUP).load()
    if not (isinstance(model, type) and issubclass(model, BaseModel)):
        raise PluginError(f"{model!r} is not a model of pydantic")
    return model


def refuse_file_of_another(model: type[BaseModel], keys: Set[str]) -> None:
    """Refuse the content of a file that is for another command than the one of ``model``.

    It has all keys that the other file requires, and the other model knows more of its keys.

    Raises
    ------
    ConfigError
        The file is for another command.
    """
    unknown = keys - model.model_fields.keys()
    others = {
        name: other
        for name, other in (file_models().items() if unknown else ())
        if not isinstance(other, Broken) and _required(other) <= keys
    }
    known = {name: other.model_fields.keys() & keys for name, other in others.items()}
    name = max(known, key=lambda name: len(known[name]), default="")
    if name and len(known[name]) > len(keys - unknown):
        required = _required(others[name])
        raise ConfigError(
            f"makes this a file for `pellicle {name}`; `pellicle explain {name}` lists its keys",
            min(known[name] & unknown, key=lambda key: (key not in required, key)),
        ) from None


def _required(model: type[BaseModel]) -> set[str]:
    return {name for name, info in model.model_fields.items() if info.is_required()}
