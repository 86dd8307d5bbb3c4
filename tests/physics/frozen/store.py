"""The stored values: read, and written one variable a line."""

import json
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent


def stored(name: str) -> dict[str, Any]:
    """Return the values of a file by name; none if there is no such file."""
    path = FOLDER / f"{name}.json"
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def store(name: str, values: dict[str, Any]) -> None:
    """Write values, of which each is a number or itself values by name."""
    (FOLDER / f"{name}.json").write_text(_lines(values) + "\n", encoding="utf-8")


def _lines(value: Any, indent: str = "") -> str:
    if not isinstance(value, dict):
        return json.dumps(value, ensure_ascii=False, separators=(",", ":"))
    inner = ",\n".join(
        f"{indent} {json.dumps(key, ensure_ascii=False)}: {_lines(value[key], indent + ' ')}"
        for key in value
    )
    return f"{{\n{inner}\n{indent}}}"
