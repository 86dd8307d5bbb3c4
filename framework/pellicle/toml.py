"""Run files: read, changed by ``--set``, and written."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from .errors import ConfigError, shown


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
    except UnicodeDecodeError:
        raise ConfigError(f"{path}: not a text file; give a TOML file in UTF-8") from None
    except (ValueError, RecursionError) as error:
        last = f"at line {len(text.splitlines())}, the end of the file"
        reason = str(error).replace("at end of document", last)
        raise ConfigError(f"{path}: not valid TOML: {reason}; correct it there") from None


def override(data: dict[str, Any], text: str) -> None:
    """Apply ``a.b=value`` to ``data``; the value is TOML, or a plain text where it is not.

    Raises
    ------
    ConfigError
        The text is not of that form, or leads where there is no table.
    """
    key, equals, value = text.partition("=")
    names = key.strip().split(".")
    if not equals or not all(names):
        raise ConfigError(f"--set {text!r} is not of the form a.b=value, e.g. grid.points=128")
    at: Any = data
    for depth, name in enumerate(names):
        where = ".".join(names[:depth])
        if isinstance(at, list):
            if not name.isdigit() or int(name) >= len(at):
                raise ConfigError(
                    f"--set {text!r}: {where} has no entry {name}; give one of its {len(at)}, "
                    "counted from 0"
                )
            at_key: Any = int(name)
        elif isinstance(at, dict):
            at_key = name
        else:
            raise ConfigError(
                f"--set {text!r}: {where} = {shown(at)} is not a table; replace it as a whole, "
                f"--set {where}=…"
            )
        if depth == len(names) - 1:
            at[at_key] = _value(value)
        elif isinstance(at, dict):
            at = at.setdefault(at_key, {})
        else:
            at = at[at_key]


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
            # JSON's text is TOML's, but for this one character.
            said = json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
            yield f"{key} = {said}\n"
    for key, value in tables.items():
        inner = f"{path}{key}"
        for entry in value if isinstance(value, list) else [value]:
            yield f"\n[[{inner}]]\n" if isinstance(value, list) else f"\n[{inner}]\n"
            yield from toml_lines(entry, f"{inner}.")


def _is_table(value: object) -> bool:
    is_list_of_tables = isinstance(value, list) and value and isinstance(value[0], dict)
    return isinstance(value, dict) or bool(is_list_of_tables)
