"""Texts, tables and JSON on the terminal, and exit codes."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, redirect_stdout
from contextvars import ContextVar
from io import StringIO
from numbers import Integral, Real
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pellicle.errors import StorageError

if TYPE_CHECKING:
    from pellicle.components import Table

Stored = Annotated[
    Path,
    typer.Argument(
        metavar="RESULTS",
        help="Folder of a run, a study or another command; result (.h5) or study.h5.",
    ),
]
InSI = Annotated[bool, typer.Option("--si", help="Print numbers in SI units.")]
AsJSON = Annotated[bool, typer.Option("--json", help="Print the result as JSON, in SI units.")]
InPart = Annotated[
    str | None,
    typer.Option(
        "--part",
        metavar="K/N",
        help="Do one of N parts of the work (3/40), or any that no other process does (any).",
    ),
]
NOT_CONVERGED, BAD_INPUT, CRASHED, INTERRUPTED = 1, 2, 70, 130
"""70 is EX_SOFTWARE of sysexits.h; Python's own 1 for a traceback would mean NOT_CONVERGED."""
_UNBOUNDED = 100_000
"""Width of what is not a terminal: lines are as long as they need be, for `grep`."""
_texts: ContextVar[list[str] | None] = ContextVar("JSON of a command", default=None)


def echo(text: str = "", err: bool = False) -> None:
    """Print a text and the end of a line."""
    _write(f"{text}\n", err)


def print_table(table: Table, title: str = "", *, si: bool = False) -> None:
    """Print a table, with ``si`` its numbers in SI; nothing if it has no columns.

    On a terminal long heads and cells are folded; elsewhere a row is a line.
    """
    from rich.console import Console

    from pellicle.show.numbers import text_of

    console = Console(color_system=None, markup=False, emoji=False, highlight=False)
    if not console.is_terminal:
        console.width = _UNBOUNDED
    if table.columns:
        if title:
            echo(f"{title}:")
        _write(text_of(table, console, si=si))


def _write(text: str, err: bool = False) -> None:
    """Write a text to a standard stream; BrokenPipeError if nobody reads it, as behind ``head``."""
    stream = sys.stderr if err else sys.stdout
    # None if it was closed at the start.
    if stream is None:
        return
    try:
        stream.write(text)
        stream.flush()
    except OSError as error:
        if err:
            return
        # Otherwise Python would try again at its end, and exit with 120.
        sys.stdout = StringIO()
        if isinstance(error, BrokenPipeError):
            raise
        raise StorageError(
            f"standard output cannot be written ({error.strerror or error})"
        ) from None


def print_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    """Print a warning; further arguments of `warnings.showwarning` are ignored."""
    echo(f"warning: {message}", err=True)


def print_json(value: object) -> None:
    """Print JSON in ASCII, which every code page contains; numbers that are not finite are null."""
    import json

    text = json.dumps(_plain(value), indent=2, allow_nan=False) + "\n"
    if (texts := _texts.get()) is None:
        _write(text)
    else:
        texts.append(text)


@contextmanager
def only_json() -> Iterator[None]:
    """Let nothing but JSON reach standard output; what components print goes to standard error."""
    texts: list[str] = []
    token = _texts.set(texts)
    try:
        with redirect_stdout(sys.stderr):
            yield
    finally:
        _texts.reset(token)
        _write("".join(texts))


def _plain(value: object) -> object:
    """Return a value of numpy or Python in a form that JSON can hold."""
    if isinstance(value, Mapping):
        return {str(name): _plain(inner) for name, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(inner) for inner in value]
    if isinstance(value, (bool, str)) or value is None:
        return value
    if isinstance(value, Integral):
        return int(value)
    if isinstance(value, Real):
        return float(value) if math.isfinite(value) else None
    return str(value)
