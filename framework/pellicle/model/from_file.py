"""Models that a file describes: a run, a study, a fit."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Self

import tomli_w

from pellicle.errors import ConfigError

from .base import Model
from .input_path import AS_GIVEN, paths_relative_to
from .paths import replaced
from .toml import parse_override, read_toml


class FromFile(Model):
    """A model that is read from TOML, JSON or a mapping, and written as TOML or JSON."""

    @classmethod
    def of(cls, configuration: Self | Mapping[str, Any] | str | Path) -> Self:
        """Return the object itself, or what a mapping or the path of a TOML file describes.

        Raises
        ------
        ConfigError, PluginError
            As for `from_toml`.
        """
        if isinstance(configuration, Mapping):
            return cls.from_mapping(configuration)
        if isinstance(configuration, (str, Path)):
            return cls.from_toml(configuration)
        return configuration

    @classmethod
    def from_mapping(cls, data: Mapping[str, Any]) -> Self:
        """Return the object that a mapping of the form of its file describes.

        Raises
        ------
        ConfigError, PluginError
            As for `from_toml`.
        """
        return cls(**data)

    @classmethod
    def from_toml(cls, path: str | Path, overrides: Iterable[str] = ()) -> Self:
        """Return the object that a TOML file describes.

        Parameters
        ----------
        path
            The file; relative paths in it start from its folder.
        overrides
            Texts such as ``'kernel.tension="5 mN/m"'`` that replace values of the file.

        Raises
        ------
        ConfigError
            The file cannot be read or used; all its problems are named at once.
        PluginError
            A component that it asks for is broken.
        """
        data = read(path, overrides)
        with paths_relative_to(Path(path).parent):
            return cls.from_mapping(data)

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Return the object that a JSON text describes, such as `to_json` returns.

        Raises
        ------
        ConfigError
            The text is not JSON, or describes something else.
        """
        try:
            data = json.loads(text)
        except json.JSONDecodeError as error:
            raise ConfigError(f"not JSON: {error}") from None
        if not isinstance(data, dict):
            raise ConfigError(f"not a JSON object; give one like {cls.__name__}.to_json() returns")
        return cls.from_mapping(data)

    def to_json(self, *, as_given: bool = False) -> str:
        """Return the whole configuration as JSON, defaults included, in SI floats.

        Paths of files to read are absolute or, ``as_given``, as the configuration's own file has
        them: such a text can be passed on with the files, and does not tell where they lay.
        """
        return self.model_dump_json(exclude_none=True, context=AS_GIVEN if as_given else None)

    def to_toml(self) -> str:
        """Return what `to_json` returns as TOML."""
        return tomli_w.dumps(json.loads(self.to_json()))


def read(path: str | Path, overrides: Iterable[str] = ()) -> dict[str, Any]:
    """Return the content of a TOML file, with the values that ``--set`` replaces.

    Raises
    ------
    ConfigError
        The file cannot be read, or an override cannot be applied.
    """
    return overridden(read_toml(Path(path)), overrides)


def overridden(data: dict[str, Any], overrides: Iterable[str]) -> dict[str, Any]:
    """Return a configuration with the values that texts such as ``"a.b=1"`` replace.

    Raises
    ------
    ConfigError
        An override cannot be applied.
    """
    for text in overrides:
        key, value = parse_override(text)
        try:
            data = replaced(data, key, value)
        except ConfigError as error:
            raise ConfigError(f"--set {text!r}: {error}") from None
    return data
