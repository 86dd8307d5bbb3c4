"""TOML files, and the overrides of ``--set``."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from pellicle.errors import ConfigError

_UNIT = r"[^\W\d_][^\s,\]}#]*|[%°][^\s,\]}#]*"
# A number with a unit, or a word that does not name a key.
_BARE = re.compile(
    rf"(?<![\w.+-])(?:[-+]?[\d.]+(?:[eE][-+]?\d+)?\s*(?:{_UNIT})|[^\W\d][\w./*-]*(?!\s*=|[\w./*-]))"
)
_WORDS = {"true", "false", "inf", "nan"}


def read_toml(path: Path) -> dict[str, Any]:
    """Return the content of a TOML file.

    Raises
    ------
    ConfigError
        The file cannot be read, or is not TOML; the message names line and column.
    """
    text = ""
    try:
        # Some editors write a byte order mark before UTF-8.
        text = path.read_text(encoding="utf-8-sig")
        return tomllib.loads(text)
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
        raise ConfigError(f"{path}: not valid TOML: {_reason(str(error), text)}") from None


def _reason(message: str, text: str) -> str:
    """Return what is wrong in a TOML text, and the remedy, given the message of the parser."""
    lines = text.splitlines()
    last = f"at line {len(lines)}, the end of the file"
    message = message.replace("at end of document", last)
    position = re.search(r"line (\d+), column \d+", message)
    if position and (value := _unquoted(lines[int(position[1]) - 1])):
        if value in ("True", "False"):
            return f"{value} is {value.lower()} in TOML ({position[0]})"
        return f'texts, and values with a unit, stand in quotes: "{value}" ({position[0]})'
    if twice := re.match(r"Cannot declare \((.*?),?\) twice(.*)", message):
        table = ".".join(name.strip(" '\"") for name in twice[1].split(","))
        return f"[{table}] is there already{twice[2]}; leave one [{table}], with the keys of both"
    message = message.replace("Cannot overwrite a value", "A key is given twice")
    return f"{message}; correct it there"


def _unquoted(line: str) -> str:
    """Return the first value of a line that lacks its quotes, or an empty text."""
    _, _, right = re.sub(r"\"[^\"]*\"|'[^']*'", '""', line).partition("=")
    value = right.partition("#")[0].strip()
    bare = next((m[0] for m in _BARE.finditer(value) if m[0] not in _WORDS), "")
    if bare and value[0] not in "[{":
        return "" if '"' in value else value
    return bare


def parse_override(text: str) -> tuple[str, Any]:
    """Return key and value of ``a.b=value``; a value that is not valid TOML counts as text.

    Raises
    ------
    ConfigError
        The text is not of that form.
    """
    key, equals, value = text.partition("=")
    if not equals or not all(key.strip().split(".")):
        raise ConfigError(f"--set {text!r} is not of the form a.b=value, e.g. grid.points=128")
    return key.strip(), _value(value)


def _value(text: str) -> Any:
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except ValueError:
        return text.strip()
