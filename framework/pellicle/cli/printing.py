"""Tables and JSON on the terminal."""

from __future__ import annotations

import math
import sys
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from io import StringIO
from numbers import Integral, Real
from typing import Any, NamedTuple

from rich.cells import cell_len
from rich.console import Console

from pellicle.errors import StorageError
from pellicle.files import for_document

from .encoding import as_printed

_GAP = 2
_NARROWEST_TEXT = 16
_texts: ContextVar[list[str] | None] = ContextVar("JSON of a command", default=None)


def echo(text: str = "", err: bool = False) -> None:
    """Print a text; on a terminal, lines that are too long for it are broken between words.

    typer would write UTF-8 where the environment wants ASCII.
    """
    stream = sys.stderr if err else sys.stdout
    # Standard streams that are closed at the start are None; a component may close them too.
    if stream is None or stream.closed:
        return
    if stream.isatty():
        width = Console(stderr=err).width
        text = "\n".join(part for line in text.split("\n") for part in _in_words(line, width))
    if not err:
        _print(f"{text}\n")
        return
    with suppress(OSError):
        stream.write(f"{text}\n")
        stream.flush()


def _print(text: str) -> None:
    """Write a text to standard output.

    Raises
    ------
    StorageError
        It cannot be written.
    BrokenPipeError
        Nobody reads it any more, as behind ``head``.
    """
    if sys.stdout is None or sys.stdout.closed:
        return
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except OSError as error:
        # Otherwise Python would try again at its end, and exit with 120.
        sys.stdout = StringIO()
        if isinstance(error, BrokenPipeError):
            raise
        raise StorageError(
            f"standard output cannot be written ({error.strerror or error})"
        ) from None


def _in_words(line: str, width: int) -> list[str]:
    """Return a line in parts of whole words that fit a width; a longer word is not broken."""
    if cell_len(line) <= width:
        return [line]
    return textwrap.wrap(line, width, break_long_words=False, break_on_hyphens=False)


def terminal_width() -> int | None:
    """Return the number of characters on a line of the terminal; None without one."""
    console = Console()
    return console.width if console.is_terminal else None


class Column(NamedTuple):
    """The head and the cells of a column."""

    head: str
    cells: Sequence[str]

    @property
    def is_text(self) -> bool:
        """Whether a cell has spaces, so that it can be folded."""
        return any(" " in cell.strip() for cell in self.cells)


def print_table(names: Sequence[str], rows: Sequence[Mapping[str, str]], caption: str = "") -> None:
    """Print rows under the names of their columns."""
    print_columns([(name, [row[name] for row in rows]) for name in names], caption)


def print_columns(columns: Sequence[tuple[str, Sequence[str]]], caption: str = "") -> None:
    """Print columns, given their heads and cells; none if there are none.

    On a terminal the table is folded, and split where that does not suffice, to fit its width.
    Output into a pipe is neither cut nor folded.
    """
    if not columns:
        return
    if caption:
        echo(f"{caption}:")
    safe = [Column(_safe(head), list(map(_safe, cells))) for head, cells in columns]
    for line in table_lines(safe, terminal_width()):
        echo(line)


def _safe(text: str) -> str:
    """Return a text as it is printed, without control characters, which a terminal obeys."""
    return as_printed(for_document(text), sys.stdout)


def table_lines(columns: Sequence[Column], width: int | None = None) -> list[str]:
    """Return the lines of a table; none is wider than ``width``, if it is given.

    Long heads are wrapped first, then long texts; a table that is still too wide is split, each
    part beginning with the first column.
    """
    natural = [max(map(cell_len, (column.head, *column.cells))) for column in columns]
    if width is None or _total(natural) <= width:
        return _lines(columns, natural)
    least = [_least(column) for column in columns]
    widths = [min(pair) for pair in zip(natural, least, strict=True)]
    spare = width - _total(widths)
    if spare >= 0:
        # The room that is left goes to the texts, then to heads, from left to right.
        for index in sorted(range(len(columns)), key=lambda i: not columns[i].is_text):
            more = min(spare, natural[index] - widths[index])
            widths[index], spare = widths[index] + more, spare - more
        return _lines(columns, widths)
    count = len(columns)
    while count > 2 and _total(widths[:count]) > width:
        count -= 1
    if _total(widths[:count]) > width or count == len(columns):
        # A terminal too narrow for two columns: their cells are broken anywhere.
        room = max(1, (width - _GAP * (count - 1)) // count)
        widths = [min(least, room) for least in widths]
        if count == len(columns):
            return _lines(columns, widths)
    first, rest = columns[:count], [columns[0], *columns[count:]]
    return [*_lines(first, widths[:count]), "", *table_lines(rest, width)]


def _total(widths: Sequence[int]) -> int:
    return sum(widths) + _GAP * (len(widths) - 1)


def _least(column: Column) -> int:
    """Return the width below which a column becomes hard to read."""
    head = max(map(cell_len, column.head.split()), default=0)
    longest = max(map(cell_len, column.cells), default=0)
    if not column.is_text:
        return max(head, longest)
    words = max((cell_len(word) for cell in column.cells for word in cell.split()), default=0)
    return max(head, min(longest, max(words, _NARROWEST_TEXT)))


def _lines(columns: Sequence[Column], widths: Sequence[int]) -> list[str]:
    """Return heads and cells, folded to their widths; heads stand on the line above the cells."""
    right = [all(map(_is_number, column.cells)) for column in columns]
    heads = [_folded(column.head, width) for column, width in zip(columns, widths, strict=True)]
    height = max(map(len, heads))
    lines = [
        _line([[""] * (height - len(head)) + head for head in heads], widths, right, number)
        for number in range(height)
    ]
    for row in zip(*(column.cells for column in columns), strict=True):
        cells = [_folded(cell, width) for cell, width in zip(row, widths, strict=True)]
        height = max(map(len, cells))
        lines += [_line(cells, widths, right, number) for number in range(height)]
    return lines


def _line(
    cells: Sequence[Sequence[str]], widths: Sequence[int], right: Sequence[bool], number: int
) -> str:
    parts = []
    for lines, width, is_number in zip(cells, widths, right, strict=True):
        text = lines[number] if number < len(lines) else ""
        padding = " " * (width - cell_len(text))
        parts.append(f"{padding}{text}" if is_number else f"{text}{padding}")
    return (" " * _GAP).join(parts).rstrip()


def _folded(text: str, width: int) -> list[str]:
    """Return a text in lines of at most ``width`` cells."""
    if cell_len(text) <= width:
        return [text]
    lines = textwrap.wrap(text, width, break_on_hyphens=False)
    if all(cell_len(line) <= width for line in lines):
        return lines
    # Letters that are two cells wide.
    return textwrap.wrap(text, max(1, width // 2))


def _is_number(text: str) -> bool:
    """Return whether a text is empty, a number, or a dash in place of one."""
    try:
        float(text.replace("∞", "inf").replace("–", "nan") or "0")
    except ValueError:
        return False
    return True


def print_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    """Print a warning; further arguments of `warnings.showwarning` are ignored."""
    echo(f"warning: {message}", err=True)


def print_json(value: object) -> None:
    """Print JSON in ASCII, which every code page contains; numbers that are not finite are null."""
    import json

    text = json.dumps(_plain(value), indent=2, allow_nan=False) + "\n"
    if (texts := _texts.get()) is None:
        _print(text)
    else:
        texts.append(text)


@contextmanager
def only_json() -> Iterator[None]:
    """Let nothing but JSON reach standard output; what components print goes to standard error."""
    from pellicle.foreign_code import diverted_output
    from pellicle.plugins import registry

    # While they are loaded, plugins are judged one by one for what they do to standard output.
    registry()
    texts: list[str] = []
    token = _texts.set(texts)
    try:
        with diverted_output():
            yield
    finally:
        _texts.reset(token)
        _print("".join(texts))


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
