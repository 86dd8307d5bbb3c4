"""TOML files, and the overrides of ``--set``."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from pellicle.errors import ConfigError


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
    except (ValueError, RecursionError) as error:
        last = f"at line {len(text.splitlines())}, the end of the file"
        reason = str(error).replace("at end of document", last)
        raise ConfigError(f"{path}: not valid TOML: {reason}; correct it there") from None


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
    except (ValueError, RecursionError):
        return text.strip()
