"""TOML files, models that are read from one, such as a run or a study, and the paths in it."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import Annotated, Any, Final, Self

import tomli_w
from pydantic import AfterValidator, PlainSerializer, SerializationInfo

from pellicle.errors import ConfigError, excerpt

from .model import Model, replace_at

_OF_A_VALUE = "Invalid value", "Expected newline", "Unclosed array", "Unclosed inline table"
"""Beginnings of messages of the parser on a value, or on what follows it."""
PORTABLE: Final = "portable"
"""Context of ``model_dump`` that writes the names of files without their folders."""
_folder: ContextVar[Path | None] = ContextVar("folder", default=None)
_is_file: ContextVar[bool] = ContextVar("a file is being read", default=False)


@contextmanager
def paths_relative_to(folder: Path | None) -> Iterator[None]:
    """Resolve relative paths in a configuration against ``folder``, the folder of its file.

    None stands for the folder of the file being read or, without one, the current folder.
    """
    token = _folder.set(folder or _folder.get() or Path.cwd())
    of_file = _is_file.set(folder is not None or _is_file.get())
    try:
        yield
    finally:
        _folder.reset(token)
        _is_file.reset(of_file)


def _from_folder(path: Path) -> Path:
    folder = _folder.get()
    return path if folder is None else (folder / path).absolute()


def _written(path: Path, info: SerializationInfo) -> Path | str:
    if info.context == PORTABLE:
        return path.name
    return str(path) if info.mode_is_json() else path


InputPath = Annotated[Path, AfterValidator(_from_folder), PlainSerializer(_written)]
"""An input file; in a TOML file, relative to that file."""


class FromFile(Model):
    """A model that is read from TOML, JSON or a mapping, and written as TOML or JSON."""

    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ConfigError:
            # Whether a file is for another command takes the import of every command.
            if _is_file.get():
                from pellicle.plugins.commands import refuse_file_of_another

                refuse_file_of_another(type(self), data.keys())
            raise

    @classmethod
    def of(cls, configuration: Self | Mapping[str, Any] | str | Path) -> Self:
        """Return the object itself, or the one that a mapping or a TOML file describes."""
        if isinstance(configuration, Mapping):
            return cls.from_mapping(configuration)
        if isinstance(configuration, (str, Path)):
            return cls.from_toml(configuration)
        if not isinstance(configuration, cls):
            raise ConfigError(
                f"{excerpt(configuration)} is not a {cls.__name__}; give one, a table of its "
                "fields or the path of a TOML file"
            )
        return configuration

    @classmethod
    def from_mapping(cls, data: Mapping[str, Any]) -> Self:
        """Return the object that a mapping in the form of its file describes."""
        return cls(**data)

    @classmethod
    def from_toml(cls, path: str | Path, overrides: Iterable[str] = ()) -> Self:
        """Return the object that a TOML file describes.

        Parameters
        ----------
        path
            The file; relative paths in it are relative to its folder.
        overrides
            Texts such as ``'kernel.tension="5 mN/m"'`` that replace values of the file.

        Raises
        ------
        ConfigError
            The file cannot be read or used; the message names all its problems.
        PluginError
            A component named in the file is broken.
        """
        data = overridden(read_toml(Path(path)), overrides)
        with paths_relative_to(Path(path).parent):
            return cls.from_mapping(data)

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Return the object that a JSON text describes, such as `to_json` returns.

        Raises
        ------
        ConfigError
            The text is not JSON, or does not describe such an object.
        """
        try:
            data = json.loads(text)
        except json.JSONDecodeError as error:
            raise ConfigError(f"not JSON: {error}") from None
        if not isinstance(data, dict):
            raise ConfigError(f"not a JSON object; give one like {cls.__name__}.to_json() returns")
        return cls.from_mapping(data)

    def to_json(self, *, portable: bool = False) -> str:
        """Return the whole configuration as JSON, defaults included, in SI floats.

        Paths of input files are absolute or, if ``portable``, the names of the files alone: such a
        text can be passed on with the files and does not reveal their folder.
        """
        return self.model_dump_json(exclude_none=True, context=PORTABLE if portable else None)

    def to_table(self, *, portable: bool = False) -> dict[str, Any]:
        """Return the whole configuration as the table of its file; see `to_json`."""
        context = PORTABLE if portable else None
        return self.model_dump(mode="json", exclude_none=True, context=context)

    def to_toml(self) -> str:
        """Return the whole configuration as TOML; see `to_json`."""
        return tomli_w.dumps(self.to_table())


def read_toml(path: Path) -> dict[str, Any]:
    """Return the content of a TOML file.

    Raises
    ------
    ConfigError
        The file cannot be read, or is not TOML; the message names line and column.
    """
    try:
        # Some editors write a byte order mark before UTF-8.
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise ConfigError(
            f"{path}: {error.strerror}; give a TOML file (`pellicle new` writes one)"
        ) from None
    except UnicodeDecodeError as error:
        line = error.object.count(b"\n", 0, error.start) + 1
        raise ConfigError(
            f"{path}: not a text file in UTF-8 (see line {line}); give a TOML file in UTF-8"
        ) from None
    except ValueError as error:
        message = str(error)
        quotes = ": texts, and values with a unit, stand in quotes"
        remedy = f"correct it there{quotes if message.startswith(_OF_A_VALUE) else ''}"
        raise ConfigError(f"{path}: not valid TOML: {message}; {remedy}") from None


def overridden(data: dict[str, Any], overrides: Iterable[str]) -> dict[str, Any]:
    """Return a configuration after applying overrides such as ``"a.b=1"``, of ``--set``.

    A value that is not valid TOML counts as text.
    """
    for text in overrides:
        key, equals, value = text.partition("=")
        if not equals or not all(key.strip().split(".")):
            raise ConfigError(f"--set {text!r} is not of the form a.b=value, e.g. grid.points=128")
        parsed: object = value.strip()
        with suppress(ValueError):
            parsed = tomllib.loads(f"value = {value}")["value"]
        try:
            data = replace_at(data, key.strip(), parsed)
        except ConfigError as error:
            raise ConfigError(f"--set {text!r}: {error}") from None
    return data
