"""The commands of the command line, found by name, imported when used.

An entry point ``command.NAME`` names a function, or a module whose hook registers one and tells
more about it; those of pellicle itself are found in the same way. Nothing heavy is imported.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache, partial
from importlib.metadata import EntryPoint, entry_points
from types import ModuleType
from typing import TYPE_CHECKING, Any

import typer

from pellicle.errors import ConfigError, PellicleError, PluginError

from .hooks import manager_of
from .origins import (
    COMMAND,
    DISABLE,
    GROUP,
    REMEDY,
    BrokenPlugin,
    Origin,
    call_isolated,
    claimed_by,
    in_order,
)

if TYPE_CHECKING:
    from pydantic import BaseModel


@dataclass(frozen=True)
class Command:
    """A command, as `hooks.RegisterCommand` gets it."""

    function: Callable[..., None]
    file: str = ""
    written: str = ""

    def __post_init__(self) -> None:
        if not callable(self.function):
            raise PluginError(f"{self.function!r} is neither a function nor a module with hooks")


@cache
def commands() -> Mapping[str, Sequence[EntryPoint]]:
    """Return who claims each command: pellicle itself first, nobody who is switched off."""
    claims: dict[str, list[EntryPoint]] = {}
    for entry, is_off in in_order(entry_points(group=GROUP), os.environ.get(DISABLE, "")):
        name = entry.name.removeprefix(COMMAND)
        if name != entry.name and not is_off:
            claims.setdefault(name, []).append(entry)
    for entries in claims.values():
        if len(entries) > 1:
            entries.sort(key=lambda entry: not Origin.of(entry).is_built_in)
    return claims


@cache
def load_command(name: str) -> Command | BrokenPlugin:
    """Return a command, or why it cannot be used.

    Of several plugins that claim it none is used, and beside pellicle itself none either.
    """
    first, *others = commands()[name]
    if others and not Origin.of(first).is_built_in:
        claim = claimed_by(map(Origin.of, (first, *others)))
        return BrokenPlugin(Origin.of(first), f"{claim}; {REMEDY}")
    return call_isolated(first, partial(_loaded, first))


def _loaded(entry: EntryPoint) -> Command:
    loaded = entry.load()
    if not isinstance(loaded, ModuleType):
        return Command(loaded)
    registered: list[Command] = []

    def register(function: Callable[..., None], **more: Any) -> None:
        registered.append(Command(function, **more))

    manager_of(loaded).hook.register_commands(register=register)
    if len(registered) != 1:
        raise PluginError(
            f"registers {len(registered)} commands; implement the hook "
            "register_commands, marked with @pellicle.hookimpl, to register one"
        )
    return registered[0]


def usable_commands() -> Mapping[str, Command]:
    """Return the commands that are not broken, by name; all are imported."""
    loaded = {name: load_command(name) for name in commands()}
    return {name: command for name, command in loaded.items() if isinstance(command, Command)}


def typer_command(name: str, **options: Any) -> Any:
    """Return what typer makes of a command, with options of `Typer.command`; or `BrokenPlugin`."""
    command = load_command(name)
    if isinstance(command, BrokenPlugin):
        return command
    app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    app.command(name, **options)(command.function)
    return call_isolated(commands()[name][0], partial(typer.main.get_command, app))


@contextmanager
def errors_attributed_to(name: str) -> Iterator[None]:
    """Add a note that names a command of a plugin to its errors, but for those meant for users."""
    try:
        yield
    except (PellicleError, typer.Exit, typer.Abort):
        raise
    except Exception as error:
        if not (origin := Origin.of(commands()[name][0])).is_built_in:
            error.add_note(f"command {name!r} of {origin} failed")
        raise


def file_models() -> Mapping[str, type[BaseModel] | BrokenPlugin]:
    """Return the model of the file of each command that takes one, or why it cannot be used.

    A broken command might take one.
    """
    models: dict[str, type[BaseModel] | BrokenPlugin] = {}
    for name in commands():
        command = load_command(name)
        if isinstance(command, BrokenPlugin):
            models[name] = command
        elif command.file:
            model = call_isolated(commands()[name][0], partial(_model, command.file))
            if isinstance(model, BrokenPlugin):
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
    """
    others = {
        name: other
        for name, other in (file_models() if keys - model.model_fields.keys() else {}).items()
        if not isinstance(other, BrokenPlugin)
        and all(key in keys for key, info in other.model_fields.items() if info.is_required())
    }
    known = {name: other.model_fields.keys() & keys for name, other in others.items()}
    name = max(known, key=lambda name: len(known[name]), default="")
    if name and len(known[name]) > len(keys & model.model_fields.keys()):
        fields = others[name].model_fields
        field = min(
            known[name] - model.model_fields.keys(),
            key=lambda key: (not fields[key].is_required(), key),
        )
        reason = (
            f"makes this a file for `pellicle {name}`; `pellicle explain {name}` lists its keys"
        )
        raise ConfigError(reason, field) from None
