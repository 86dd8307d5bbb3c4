"""Numbers in text, separated by blanks, commas or semicolons."""

from __future__ import annotations

import re

_NUMBERS = re.compile(r"(?:[-+\d.,;\s]|[eE](?=[-+\d])|nan|NaN)+")
_BETWEEN_BLANKS = re.compile(r"\d[^\S\n]+[-+\d]")
_EMPTY = re.compile(r"(?<=[,;])[^\S\n]*(?=[,;])|^(?=[,;])")


def separated_by_blanks(lines: list[str]) -> list[str]:
    """Return lines of text with blanks between their numbers; lines of other text are unchanged.

    A comma is that of a decimal where semicolons or blanks separate the numbers. An empty entry
    becomes NaN; a separator at the end of a line is ignored.
    """
    rows = {i: line for i, line in enumerate(lines) if _NUMBERS.fullmatch(line)}
    mark = ";" if any(";" in row for row in rows.values()) else ","
    if mark == "," and any(map(_BETWEEN_BLANKS.search, rows.values())):
        mark = ""
    for i, row in rows.items():
        row = row.rstrip()
        if mark:
            row = _EMPTY.sub("nan", row.removesuffix(mark)).replace(mark, " ")
        lines[i] = row.replace(",", ".")
    return lines
