"""Tables of numbers in text files, as instruments and spreadsheets export them."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConfigError, StorageError
from pellicle.files import read_text

from .columns import EXAMPLE, NAMES, Column, Columns, is_curve, plain, si_unit
from .missing import UNKNOWN, guessed

FILE = "file"
"""Name of the column of a table that lists files."""
_HEAD = re.compile(r"([^\[(]*)(?:[\[(]([^\])]*)[\])])?")
_WORD = re.compile(r"[^\s\[(]+(?:\s?[\[(][^\])]*[\])])?")
"""A column's name and unit in a header whose columns are separated by spaces."""
_WHOLE = re.compile(r"[-+]?[1-9]\d{0,2}")
_GROUPED = re.compile(rf"{_WHOLE.pattern}(?:,\d{{3}})+")
"""A number whose thousands may be separated by commas."""
_COMMENT = ("#", "%")
_PREAMBLE = 200
"""Lines in which a header is sought."""


def read_cells(
    path: Path, mapped: Mapping[str, str] | None = None
) -> tuple[list[Column], list[list[str]], str]:
    """Return heads and rows of cells of a table, and what separates them; empty if it is no text.

    A row of units may follow the header, and the columns of a table without one have numbers.  The
    rows are as long as the heads or longer.
    """
    try:
        text = read_text(path)
    except OSError as error:
        raise StorageError(f"{path}: cannot be read ({error.strerror or error})") from None
    except ValueError:
        return [], [], ""
    lines = [line for line in text.splitlines() if line.strip()]
    data = [number for number, line in enumerate(lines) if not line.startswith(_COMMENT)]
    if not data:
        raise ConfigError(f"{path}: is empty; give a table with the header {EXAMPLE!r}")
    # A cell that is longer than any number is no text.
    with suppress(csv.Error):
        header, heads = _header(lines, data, mapped or {})
        below = [lines[number] for number in data if number > header]
        # The heads may be separated by other signs than the numbers, and a first row be short.
        separator = next((s for s in map(_separator, below[:3]) if s != " "), " ")
        rows = _split(below, separator)
        # The rows of a list of files may have no number either.
        is_list = FILE in [head.name.lower() for head in heads]
        if rows and not is_list and not any(map(_is_number, rows[0])):
            units = [plain(cell).strip("[]()") for cell in rows.pop(0)]
            units += [""] * len(heads)
            heads = [
                head._replace(unit=head.unit or (unit if si_unit(unit) else ""))
                for head, unit in zip(heads, units, strict=False)
            ]
        width = max(map(len, rows[:1]), default=0)
        heads += [Column("", str(index + 1), "") for index in range(len(heads), width)]
        return heads, [row + [""] * (len(heads) - len(row)) for row in rows], separator
    return [], [], ""


def _header(
    lines: Sequence[str], data: Sequence[int], mapped: Mapping[str, str]
) -> tuple[int, list[Column]]:
    """Return the number of the line above the rows, and its heads.

    It is the first line that has the ``mapped`` columns or, without them, those of a curve or of a
    list of files, or may have them, or the last such comment above it; else the first line.
    """
    likely = (*data[:_PREAMBLE], *reversed(range(data[0])))
    heads = {number: _heads(lines[number]) for number in likely}
    wanted = [name for name in mapped if not name.isdecimal()]
    for number, found in heads.items():
        names = {head.name.lower() for head in found}
        is_known = not mapped and (is_curve(names) or FILE in names)
        if is_known or (wanted and all(any(h.is_called(name) for h in found) for name in wanted)):
            return number, found
    width = len(_heads(lines[data[-1]]))
    for number, found in () if mapped else heads.items():
        known = len(found) == width and guessed(found, {}).values()
        if known and all(column.name != UNKNOWN for column in known):
            return number, found
    first = heads[data[0]]
    are_numbers = all(_is_number(head.text) for head in first if head.text)
    return (data[0] - 1, []) if are_numbers else (data[0], first)


def _heads(line: str) -> list[Column]:
    # JPK writes "columns:" before the names.
    line = re.sub(r"^\s*columns:", "", line.lstrip("".join(_COMMENT)))
    separator = _separator(line)
    cells = _WORD.findall(line) if separator == " " else _split([line], separator)[0]
    heads = []
    for text in map(plain, cells):
        match = _HEAD.fullmatch(text)
        name, unit = match.groups(default="") if match else (text, "")
        heads.append(Column(text, name.strip(), unit.strip()))
    return heads


def _separator(line: str) -> str:
    line = line.strip()
    if "\t" in line or ";" in line:
        return max("\t;", key=line.count)
    return "," if "," in line else " "


def _split(lines: Sequence[str], separator: str) -> list[list[str]]:
    if separator == " ":
        return [line.split() for line in lines]
    return list(csv.reader(lines, delimiter=separator))


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", ".", 1))
    except ValueError:
        return False
    return True


def read_table(path: Path, mapped: Mapping[str, str]) -> tuple[dict[str, Columns], list[Column]]:
    """Return columns of the curve of a table, known or ``mapped``, if it is text; and all heads."""
    heads, rows, separator = read_cells(path, mapped)
    names = [head.name.lower() for head in heads]
    if not mapped and separator == "," and is_curve({*names}):
        named = sum(bool(head.text) for head in heads)
        for row in rows:
            if len(row) > named and all(map(_is_number, row)):
                raise ConfigError(
                    f"{path}: has {len(row)} numbers below {named} names ({','.join(row)}), "
                    "as where commas are decimal and separate columns too; export it with "
                    "semicolons, tabs or decimal points, or choose columns by their numbers "
                    "(--columns on the command line)"
                )
    columns = {}
    for name, text in (mapped or {name: name for name in names if name in NAMES}).items():
        matches = [index for index, head in enumerate(heads) if head.is_called(name)]
        if not matches and name.isdecimal() and 1 <= int(name) <= len(heads):
            matches = [int(name) - 1]
        if len(matches) == 1:
            role, _, unit = text.partition(" ")
            head, texts = heads[matches[0]], [row[matches[0]].strip() for row in rows]
            values = _numbers(texts, separator, f"{path}: column {head.name}")
            columns[role] = head._replace(unit=unit or head.unit, values=values)
    return ({"": columns} if heads else {}), heads


def _numbers(cells: list[str], separator: str, column: str) -> Array:
    """Return numbers; NaN where a cell holds none.  A comma in them is decimal, or refused."""
    digits = [cell for cell in cells if _is_number(re.sub("[.,]", "", cell))]
    commas, beside = ([cell for cell in digits if mark in cell] for mark in ",.")
    if commas and all(map(_GROUPED.fullmatch, commas)):
        beside += filter(_WHOLE.fullmatch, digits)
    if commas and (beside or separator == ","):
        raise ConfigError(
            f"{column} has {commas[0]!r} beside {[*beside, *digits][0]!r}, so its commas may be "
            "those of decimals or of thousands; export it without separators of thousands, and "
            "with decimals in all rows"
        )
    return np.array([float(c.replace(",", ".")) if _is_number(c) else np.nan for c in cells])
