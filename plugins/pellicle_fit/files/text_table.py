"""Tables of numbers in text files, as instruments and spreadsheets export them."""

from __future__ import annotations

import csv
import re
import unicodedata
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConfigError, StorageError, shown
from pellicle.files import read_text
from pellicle.units import Quantity

from .columns import EXAMPLE, LABEL, NAMES, Channel, Columns, is_curve

FILE = "file"
"""Name of the column of a table that lists files."""
_HEAD = re.compile(r"([^\[(]*)(?:[\[(]([^\])]*)[\])])?")
_WORD = re.compile(r"[^\s\[(]+(?:\s?[\[(][^\])]*[\])])?")
"""A column's name and unit in a header whose columns are separated by spaces."""
_WHOLE = re.compile(r"[-+]?[1-9]\d{0,2}")
_GROUPED = re.compile(rf"{_WHOLE.pattern}(?:,\d{{3}})+(?:\.\d*)?")
"""A number whose thousands are separated by commas."""
_COMMENT = ("#", "%")
_PREAMBLE = 200
"""Lines in which a header is sought."""
_UNIT_ROWS = 3
"""Rows below a header that may hold units instead of numbers."""


class Head(NamedTuple):
    """The head of a column, such as ``position [um]``."""

    text: str
    """All of it."""
    name: str
    unit: str

    def is_called(self, name: str) -> bool:
        """Return whether a user who writes ``name`` may mean this column."""
        return _plain(name).lower() in (self.text.lower(), self.name.lower())


@dataclass(frozen=True)
class Cells:
    """The cells of a table as texts."""

    heads: tuple[Head, ...]
    """Heads of the columns; none if the table begins with numbers."""
    rows: list[list[str]]
    separator: str

    @property
    def names(self) -> list[str]:
        """Names of the columns in lower case."""
        return [head.name.lower() for head in self.heads]


def read_cells(path: Path, mapped: Mapping[str, str] | None = None) -> Cells | None:
    """Return the cells of a table; None if the file is not text.

    The header is the first line that has the ``mapped`` columns or, without them, those of a curve
    or of a list of files; else the last comment above numbers; else the first line.

    Raises
    ------
    StorageError
        The file cannot be read.
    ConfigError
        The file is empty.
    """
    try:
        text = read_text(path)
    except OSError as error:
        raise StorageError(f"{path}: cannot be read ({error.strerror or error})") from None
    except ValueError:
        return None
    lines = [line for line in text.splitlines() if line.strip()]
    data = [line for line in lines if not line.startswith(_COMMENT)]
    if not data:
        raise ConfigError(f"{path}: is empty; give a table with the header {EXAMPLE!r}")
    # A cell that is longer than any number is no text.
    with suppress(csv.Error):
        for number, line in enumerate(data[:_PREAMBLE]):
            if _fits(heads := _heads(line), mapped or {}):
                return _below(heads, data[number + 1 :], _separator(line))
        separator = _separator(data[0])
        (first,) = _split(data[:1], separator)
        if not all(_is_number(cell) for cell in first if cell.strip()):
            return _below(_heads(data[0]), data[1:], separator)
        above = reversed(lines[: lines.index(data[0])])
        comments = [_heads(line.lstrip("".join(_COMMENT))) for line in above]
        likely = [heads for heads in comments if _fits(heads, mapped or {})]
        likely += [heads for heads in comments[:1] if len(heads) == len(first)]
        return _below(next(iter(likely), ()), data, separator)
    return None


def _fits(heads: tuple[Head, ...], mapped: Mapping[str, str]) -> bool:
    """Return whether heads are those of the table that is sought."""
    if not mapped:
        names = {head.name.lower() for head in heads}
        return is_curve(names) or FILE in names
    named = [name for name in mapped if not name.isdecimal()]
    return bool(named) and all(any(head.is_called(name) for head in heads) for name in named)


def _heads(line: str) -> tuple[Head, ...]:
    separator = _separator(line)
    cells = _WORD.findall(line) if separator == " " else _split([line], separator)[0]
    heads = []
    for text in map(_plain, cells):
        match = _HEAD.fullmatch(text)
        name, unit = match.groups(default="") if match else (text, "")
        heads.append(Head(text, name.strip(), unit.strip()))
    return tuple(heads)


def _plain(text: str) -> str:
    """Return a text with one kind of µ and of space."""
    return " ".join(unicodedata.normalize("NFKC", text).replace("μ", "µ").split())


def _separator(line: str) -> str:
    line = line.strip()
    if "\t" in line or ";" in line:
        return max("\t;", key=line.count)
    return "," if "," in line else " "


def _split(lines: Sequence[str], separator: str) -> list[list[str]]:
    if separator == " ":
        return [line.split() for line in lines]
    return list(csv.reader(lines, delimiter=separator))


def _below(heads: tuple[Head, ...], lines: list[str], separator: str) -> Cells:
    """Return the table below its header, after the rows that hold units."""
    if lines and separator == " ":
        separator = _separator(lines[-1])
    rows = _split(lines, separator)
    if not heads:
        return Cells(heads, rows, separator)
    names = {head.name.lower() for head in heads}
    # The rows of a list of files may hold no number either.
    most = 0 if FILE in names and not is_curve(names) else min(_UNIT_ROWS, len(rows))
    units = 0
    while units < most and not any(map(_is_number, rows[units])):
        units += 1

    def unit(index: int) -> str:
        cells = [_plain(row[index]).strip("[]()") for row in rows[:units] if index < len(row)]
        for cell in cells:
            for dimension in "mNVs":
                with suppress(ValueError):
                    Quantity(dimension)(f"1 {cell}")
                    return cell
        return ""

    heads = tuple(h if h.unit else h._replace(unit=unit(i)) for i, h in enumerate(heads))
    return Cells(heads, rows[units:], separator)


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", ".", 1))
    except ValueError:
        return False
    return True


def curves_of(path: Path, cells: Cells, mapped: Mapping[str, str]) -> dict[str, Columns]:
    """Return the known columns of each curve of a table, or those that ``mapped`` names.

    Raises
    ------
    ConfigError
        A column is missing, or several have its name, or the commas of one are ambiguous.
    """
    names = cells.names
    if not mapped and cells.separator == "," and _fits(cells.heads, {}):
        for row in cells.rows:
            if len(row) > len(names) and all(map(_is_number, row)):
                raise ConfigError(
                    f"{path}: has {len(row)} numbers below {len(names)} names ({','.join(row)}), "
                    "as where commas are decimal and separate columns too; export it with "
                    "semicolons, tabs or decimal points, or choose columns by their numbers "
                    "(--columns on the command line)"
                )
    mapped = mapped or {name: name for name in names if name in (*NAMES, LABEL)}
    roles = {text: _index(path, cells, name) for name, text in mapped.items()}
    label = next((index for role, index in roles.items() if role.split()[0] == LABEL), None)
    curves: dict[str, list[list[str]]] = {"": cells.rows}
    if label is not None and len(roles) > 1:
        curves = {}
        for row in cells.rows:
            curves.setdefault(row[label].strip() if label < len(row) else "", []).append(row)
    tables: dict[str, Columns] = {}
    for text, rows in curves.items():
        columns = {}
        for role, index in roles.items():
            name, _, unit = role.partition(" ")
            if name != LABEL:
                heads = cells.heads[index : index + 1] or (Head("", str(index + 1), ""),)
                (head,) = heads
                texts = [row[index].strip() if index < len(row) else "" for row in rows]
                values = _numbers(texts, cells.separator, f"{path}: column {head.name}")
                columns[name] = Channel(unit or head.unit, values, head.name)
        tables[text] = columns
    return tables


def _index(path: Path, cells: Cells, name: str) -> int:
    """Return the index of the column with a name or, if none has it, a number."""
    matches = [index for index, head in enumerate(cells.heads) if head.is_called(name)]
    if len(matches) == 1:
        return matches[0]
    width = max(len(cells.heads), *(len(row) for row in cells.rows[:1]), 0)
    if not matches and name.isdecimal() and 1 <= int(name) <= width:
        return int(name) - 1
    has = ", ".join(map(shown, [head.text for head in cells.heads] or cells.rows[0]))
    problem, advice = f"no column {name!r}", "give a name of one column, or its number from 1 to"
    if matches:
        problem = f"{len(matches)} columns {name!r}"
        advice = (
            f"give one curve to a file, tell curves apart by a column {LABEL}, or choose columns "
            "by their numbers (--columns on the command line), from 1 to"
        )
    raise ConfigError(f"{path}: has {problem} (it has {has}); {advice} {width}", "columns")


def _numbers(cells: list[str], separator: str, column: str) -> Array:
    """Return numbers; NaN where a cell holds none.

    In a column that has points, a comma is not decimal, and may group thousands.
    """
    commas = [cell for cell in cells if "," in cell]
    decimal = separator != "," and not any("." in cell for cell in cells)
    grouped = all(map(_GROUPED.fullmatch, commas))
    whole = next(filter(_WHOLE.fullmatch, cells), None) if commas and grouped else None
    if decimal and whole:
        raise ConfigError(
            f"{column} has {commas[0]!r} beside {whole!r}, so its commas may be those of decimals "
            "or of thousands; export it without separators of thousands, and with decimals in all "
            "rows"
        )
    mark = "." if decimal else "" if grouped else ","
    values = np.full(len(cells), np.nan)
    for number, cell in enumerate(cells):
        with suppress(ValueError):
            values[number] = float(cell.replace(",", mark))
    return values
