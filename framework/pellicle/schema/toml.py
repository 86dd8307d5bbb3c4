"""TOML files, and the overrides of ``--set``."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from pellicle.errors import ConfigError

_OF_A_VALUE = "Invalid value", "Expected newline", "Unclosed array", "Unclosed inline table"
"""Beginnings of messages of the parser on a value, or on what follows it."""


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
        raise ConfigError(f"{path}: not valid TOML: {_reason(str(error))}") from None


def _reason(message: str) -> str:
    """Return what is wrong in a TOML text, and the remedy, given the message of the parser."""
    if twice := re.match(r"Cannot declare \((.*?),?\) twice(.*)", message):
        table = ".".join(name.strip(" '\"") for name in twice[1].split(","))
        return f"[{table}] is there already{twice[2]}; leave one [{table}], with the keys of both"
    if message.startswith("Cannot overwrite a value"):
        return f"{message.replace('Cannot overwrite a value', 'A key is given twice')}; leave one"
    quotes = ": texts, and values with a unit, stand in quotes"
    return f"{message}; correct it there{quotes if message.startswith(_OF_A_VALUE) else ''}"


def parse_override(text: str) -> tuple[str, Any]:
    """Return key and value of ``a.b=value``; a value that is not valid TOML counts as text."""
    key, equals, value = text.partition("=")
    if not equals or not all(key.strip().split(".")):
        raise ConfigError(f"--set {text!r} is not of the form a.b=value, e.g. grid.points=128")
    try:
        return key.strip(), tomllib.loads(f"value = {value}")["value"]
    except ValueError:
        return key.strip(), value.strip()
