"""JSON files with a checksum of their content, so that one that was edited or cut is found."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from pellicle.errors import StorageError
from pellicle.files import atomic_write, json_text

_BLOCK = 1 << 20
"""Bytes that are read at once."""


def json_lines(value: Mapping[str, Any], curves: Iterable[Any]) -> Iterator[str]:
    """Yield the text of JSON data and of the ``curves`` in them, each on a line of its own.

    So that those of a large population are never in memory together.
    """
    yield json_text(value).removesuffix("\n}\n") + ',\n  "curves": ['
    separator = "\n"
    for curve in curves:
        yield f"{separator}{json.dumps(curve)}"
        separator = ",\n"
    yield "\n]\n}\n"


def write_sealed(value: Mapping[str, Any], path: Path, curves: Iterable[Any] | None = None) -> Path:
    """Write ``value``, the ``curves`` in it a line each, and a checksum to a JSON file."""
    texts = iter([json_text(value)]) if curves is None else json_lines(value, curves)
    with atomic_write(path) as part, part.open("w", encoding="ascii", newline="\n") as file:
        first = next(texts)
        file.write(_head("0" * hashlib.sha256().digest_size * 2) + first.removeprefix("{\n"))
        digest = hashlib.sha256(first.encode())
        for text in texts:
            digest.update(text.encode())
            file.write(text)
        file.seek(0)
        file.write(_head(digest.hexdigest()))
    return path


def read_sealed(path: Path, keep: Callable[[Any], Any] | None = None) -> dict[str, Any]:
    """Return what `write_sealed` wrote; for any other file it raises a StorageError.

    Of curves a line each, ``curves`` is the list of what ``keep`` returns of one.
    """
    try:
        with path.open("rb") as file:
            head, digest = file.readline() + file.readline(), hashlib.sha256(b"{\n")
            for block in iter(partial(file.read, _BLOCK), b""):
                digest.update(block)
            if head == _head(digest.hexdigest()).encode():
                file.seek(len(head))
                rest, curves = [b"{\n"], []
                for line in file:
                    if keep is not None and line.startswith(b"{"):
                        curves.append(keep(json.loads(line.rstrip(b",\n"))))
                    else:
                        rest.append(line)
                whole: dict[str, Any] = json.loads(b"".join(rest))
                return whole if keep is None else whole | {"curves": curves}
    except OSError:
        pass
    raise StorageError(f"{path}: is missing, or was changed since pellicle wrote it; fit again")


def _head(checksum: str) -> str:
    return f'{{\n  "checksum": "{checksum}",\n'
