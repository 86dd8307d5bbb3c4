"""Tables of numbers in text, as instruments and spreadsheets export them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConfigError
from pellicle.files import fault_of_commas, read_text

from .file_checks import require_memory

FORMAT_MARKS = "aISO-", "Wyko ASCII"
"""Beginnings of texts whose numbers have a scale of their own, which SurfaceTopography reads."""
_PER_CHARACTER, _PER_SEPARATOR, _PER_LINE, _PER_ENTRY = 10, 15, 240, 80
"""Peak memory while a text is parsed [bytes], of which the last is for entries of the longest line.

Measured are 9 at 1000² zeros, 22 for rows of commas, 220 for lines of one number, 76 for a line of
commas.
"""
_FEWEST = 4
"""Least number of entries of a row with a word above all others; a header may be ``Size 10 um``."""
# A possessive repetition keeps no place to return to, which takes 120 bytes a character.
_NUMBERS = re.compile(
    r"(?:[\d.,;\s]|[-+](?=[\d.,iI])|[eE](?=[-+\d])|(?i:nan|bad|inf(?:init[ey])?))++"
)
_NUMBER = re.compile(r"[-+]?\.?\d")
_MISSING = re.compile("(?i:bad|[-+]?inf(?:init[ey])?)")
_BETWEEN_BLANKS = re.compile(r"\d[^\S\n]+[-+\d]")
# Spreadsheets write #N/A for a missing value.
_COMMENT = re.compile(r"#(?!N/A)|^\s*%")
_ENTRY = re.compile("[:=：]")
# Gwyddion names images in the language of its user.
_CHANNEL = re.compile(r"\b(?:Channel|Kanál|Kanal|Canale?|チャネル|채널|Канал)\s*[=:：]\s*(.*\S)")


class TextTable(NamedTuple):
    """Rows of numbers."""

    values: Array
    """Shape (rows, columns); NaN where there is no number."""
    header: list[str]
    """The other lines of the file, up to the last of the rows or, below all rows, the last."""


def text_in(path: Path) -> str:
    """Return the text of a file if there is memory for it."""
    size = path.stat().st_size
    require_memory(3.0 * size, f"{path}, a file of {size / 1e9:.3g} GB,")
    # Some programs write minus signs of their own.
    return read_text(path).replace("\N{MINUS SIGN}", "-")


def read_tables(text: str, path: Path) -> dict[str, TextTable]:
    """Return the tables in the text of a file by the names of their channels; none without numbers.

    Numbers are separated by blanks, tabs, commas or semicolons. A comma is that of a decimal where
    semicolons, tabs or blanks separate the numbers. An empty entry is NaN; a separator at the end
    of a line is ignored unless the row lacks an entry.
    """
    lines = text.splitlines()
    longest = max(map(len, lines), default=0)
    needed = _PER_CHARACTER * len(text) + _PER_LINE * len(lines) + _PER_ENTRY * longest
    needed += _PER_SEPARATOR * sum(map(text.count, ",;\t"))
    require_memory(needed, f"{path}, a file of {len(text) / 1e9:.3g} GB,")
    bodies = [_COMMENT.split(line, maxsplit=1)[0] for line in lines]
    rows, mark = _rows(bodies)
    if not any(map(str.strip, rows.values())):
        return {}
    widths = {number: len(row.split()) for number, row in rows.items()}
    if mark == "," and (reason := fault_of_commas(map(str.split, rows.values()))):
        raise ConfigError(f"{path} {reason}", "path")
    channels: dict[str, list[int]] = {}
    texts = []
    name = "Default"
    for number, body in enumerate(bodies):
        if number in rows:
            channels.setdefault(name, []).append(number)
        elif match := _CHANNEL.search(lines[number]):
            name = match[1]
        elif body.strip() and not _ENTRY.search(body):
            texts.append(number)
    _require_no_words(bodies, texts, widths, mark, path)
    last = max(rows)
    tables = {}
    for name, numbers in channels.items():
        first = numbers[0]
        for number in numbers:
            if widths[number] != widths[first]:
                raise ConfigError(
                    f"{path} has rows of {widths[first]} and {widths[number]} numbers, in lines "
                    f"{first + 1} and {number + 1}: it is damaged, or commas separate its columns "
                    "and its decimals too; export it again",
                    "path",
                )
        end = None if numbers[-1] == last else numbers[-1]
        header = [line for number, line in enumerate(lines[:end]) if number not in rows]
        tables[name] = TextTable(np.loadtxt([rows[n] for n in numbers], ndmin=2), header)
    return tables


def _rows(bodies: list[str]) -> tuple[dict[int, str], str]:
    """Return the lines that hold numbers alone, separated by blanks, and what separated them."""
    rows = {i: row for i, row in enumerate(bodies) if _NUMBERS.fullmatch(row) and row.strip()}
    mark = next((mark for mark in ";\t" if any(mark in row for row in rows.values())), "")
    if not mark and not any(map(_BETWEEN_BLANKS.search, rows.values())):
        mark = "," if any("," in row for row in rows.values()) else ""
    if mark:
        empty = re.compile(f"(?<={mark}) *(?={mark})|^ *(?={mark})")
        whole = {i: row.rstrip(" ") for i, row in rows.items()}
        rows = {i: empty.sub("nan", row.removesuffix(mark)) for i, row in whole.items()}
        most = max(row.count(mark) for row in rows.values())
        for i, row in rows.items():
            lacks_last = whole[i].endswith(mark) and row.count(mark) == most - 1
            rows[i] = (f"{row}{mark}nan" if lacks_last else row).replace(mark, " ")
    return {i: _MISSING.sub("nan", row).replace(",", ".") for i, row in rows.items()}, mark


def _require_no_words(
    bodies: list[str], texts: list[int], widths: dict[int, int], mark: str, path: Path
) -> None:
    """Refuse a row with a word among its numbers: without it the rows below would move up.

    Such is a line of text below the first row that has a number or the length of a row; above it,
    one of that length with a number or with a word twice. Other lines are titles and headings.
    """
    first, lengths = min(widths), set(widths.values())
    for number in texts:
        entries = [entry.strip() for entry in bodies[number].split(mark or None)]
        words = [entry for entry in entries if entry and not _NUMBERS.fullmatch(entry)]
        is_row = len(entries) in lengths
        if number > first:
            is_row = is_row or len(words) < len(entries)
        else:
            headings = {word for word in words if not _NUMBER.match(word)}
            is_row = is_row and len(entries) >= _FEWEST and len(headings) < len(entries)
        if is_row:
            raise ConfigError(
                f"{path} has {(words or entries)[0]!r} among the numbers of line {number + 1}; "
                "write nan for a missing point, or, between other separators than blanks, nothing",
                "path",
            )
