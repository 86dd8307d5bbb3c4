"""Run files: read, changed by ``--set``, and written."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, cast

from .errors import ConfigError


def read_toml(path: Path) -> dict[str, Any]:
    """Return the content of a TOML file.

    Raises
    ------
    ConfigError
        It cannot be read, or is not TOML; the message names line and column.
    """
    text = ""
    try:
        # Some editors put a byte order mark in front of UTF-8.
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
    """Return key and value of ``a.b=value``; the value is TOML, or a plain text where it is not.

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


def toml_lines(table: Mapping[str, Any], path: str = "") -> Iterable[str]:
    """Yield the TOML of a table whose values are JSON's: plain values first, then its tables."""
    tables = {k: v for k, v in table.items() if _is_table(v)}
    for key, value in table.items():
        if key not in tables:
            yield f"{_key(key)} = {_inline(value)}\n"
    for key, value in tables.items():
        inner = f"{path}{_key(key)}"
        for entry in value if isinstance(value, list) else [value]:
            yield f"\n[[{inner}]]\n" if isinstance(value, list) else f"\n[{inner}]\n"
            yield from toml_lines(entry, f"{inner}.")


def _is_table(value: object) -> bool:
    is_list = isinstance(value, list) and value
    return isinstance(value, dict) or (
        bool(is_list) and all(isinstance(entry, dict) for entry in cast("list[Any]", value))
    )


def _key(name: str) -> str:
    return name if re.fullmatch(r"[\w-]+", name, re.ASCII) else _inline(name)


def _inline(value: Any) -> str:
    if isinstance(value, dict):
        return f"{{{', '.join(f'{_key(k)} = {_inline(v)}' for k, v in value.items())}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(_inline, value))}]"
    # JSON's text is TOML's, but for this one character.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
