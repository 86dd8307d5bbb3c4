"""Numbers in text, separated by blanks, tabs, commas or semicolons."""

from __future__ import annotations

import re
from contextlib import suppress

_NUMBERS = re.compile(r"(?:[\d.,;\s]|[-+](?=[\d.,])|[eE](?=[-+\d])|(?i:nan|bad))+")
_BETWEEN_BLANKS = re.compile(r"\d[^\S\n]+[-+\d]")
_BLANK_AND_WORD = re.compile(r"\d[^\S\n]+\S")
# Spreadsheets write #N/A for a missing value.
_HEADER = re.compile(r"\s*(?:#(?!N/A)|%)|.*[:=]")
_FEWEST = 4
"""Least number of entries of a row; three may be those of a header such as ``Size 10 um``."""


def separated_by_blanks(lines: list[str]) -> list[str]:
    """Return lines of text with blanks between their numbers; lines of other text are unchanged.

    A comma is that of a decimal where semicolons, tabs or blanks separate the numbers. An empty
    entry becomes NaN; a separator at the end of a line is ignored unless the row lacks an entry.
    """
    rows = {i: line for i, line in enumerate(lines) if _NUMBERS.fullmatch(line) and line.strip()}
    mark = _mark(rows)
    if mark:
        empty = re.compile(f"(?<={mark}) *(?={mark})|^ *(?={mark})")
        whole = {i: row.rstrip("\r\n ") for i, row in rows.items()}
        rows = {i: empty.sub("nan", row.removesuffix(mark)) for i, row in whole.items()}
        most = max(row.count(mark) for row in rows.values())
        for i, row in rows.items():
            lacks_last = whole[i].endswith(mark) and row.count(mark) == most - 1
            rows[i] = (f"{row}{mark}nan" if lacks_last else row).replace(mark, " ")
    for i, row in rows.items():
        lines[i] = row.rstrip().replace(",", ".")
    return lines


def word_in_row(lines: list[str], width: int) -> tuple[int, str] | None:
    """Return the first line, counted from 1, with a word in a row of numbers, and that word.

    Such a line has ``width`` entries, of which some are numbers or all are one word: readers take
    it for a header and skip it, so that the rows below would move up. None if there is none.
    """
    if width < _FEWEST:
        return None
    for number, line in enumerate(lines, start=1):
        if _NUMBERS.fullmatch(line) or _HEADER.match(line):
            continue
        entries = [entry.strip() for entry in _entries(line)]
        words = [entry for entry in entries if not _is_number(entry)]
        if len(entries) == width and (len(words) < width or len(set(words)) == 1):
            return number, next(filter(None, words), "")
    return None


def _mark(rows: dict[int, str]) -> str:
    """Return what separates the numbers of rows besides blanks; empty if nothing does."""
    for mark in ";\t":
        if any(mark in row for row in rows.values()):
            return mark
    if any(map(_BETWEEN_BLANKS.search, rows.values())):
        return ""
    return "," if any("," in row for row in rows.values()) else ""


def _entries(line: str) -> list[str]:
    """Return the entries of a line that need not be numbers."""
    for mark in ";\t":
        if mark in line:
            return line.split(mark)
    return line.split("," if "," in line and not _BLANK_AND_WORD.search(line) else None)


def _is_number(entry: str) -> bool:
    with suppress(ValueError):
        float(entry.replace(",", "."))
        return True
    return not entry or entry.lower() == "bad"
